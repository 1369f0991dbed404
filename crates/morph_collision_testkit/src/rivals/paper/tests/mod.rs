//! Blended volumes contain what they bound, are no larger than the paper says, and are computed only on
//! demand.

mod blending;
mod building;
mod places;
mod walking;

use std::sync::Arc;

use super::PaperVolume;
use super::body::Body;
use super::tree::Content;
use super::volume::Volume;
use crate::rivals::blended::WeldedMesh;
use morph_collision_models::generated::{dolphin, random};
use morph_collision_models::mesh::MorphMesh;

fn meshes() -> [Arc<WeldedMesh>; 3] {
    [
        random::random_blob(7, 2, 6, 0.5),
        random::triangle_soup(11, 120, 3),
        dolphin(0),
    ]
    .map(|mesh| welded(&mesh))
}

fn welded(mesh: &MorphMesh) -> Arc<WeldedMesh> {
    Arc::new(WeldedMesh::new(mesh).unwrap())
}

/// The triangles below a node.
fn below<V: Volume>(body: &Body<V>, node: u32) -> Vec<u32> {
    match body.tree.content(node).clone() {
        Content::Triangle(triangle) => vec![triangle],
        Content::Children(children) => children.flat_map(|child| below(body, child)).collect(),
    }
}

fn volume<V: Volume>(body: &mut Body<V>, node: u32) -> V {
    body.refit(node, &mut Default::default());
    *body.volume(node)
}

#[test]
fn names_lead_back_to_their_volumes() {
    for volume in PaperVolume::ALL {
        assert_eq!(volume.to_string().parse(), Ok(volume));
    }
    let error = "kdop6".parse::<PaperVolume>().unwrap_err().to_string();
    assert!(error.contains("'kdop6'") && error.contains("aabb, kdop14"), "{error}");
}
