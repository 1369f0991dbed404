//! The shape of trees.

use glam::Vec3;

use super::super::body::Body;
use super::super::slabs::Slabs;
use super::super::tree::Content;
use super::{below, meshes, welded};
use crate::mesh::MorphMesh;

#[test]
fn leaves_have_one_triangle_each_and_no_child_is_empty() {
    for mesh in meshes() {
        let body = Body::<Slabs<3>>::new(&mesh, false);
        let mut triangles = below(&body, 0);
        triangles.sort_unstable();
        assert!(triangles.into_iter().eq(0..mesh.triangles.len() as u32));
        for node in 0..body.tree.node_count() as u32 {
            if let Content::Children(children) = body.tree.content(node) {
                assert!((2..=8).contains(&children.len()), "{children:?}");
            }
        }
    }
}

/// Small triangles in some corners of a cube.
fn in_corners(corners: &[Vec3]) -> MorphMesh {
    let positions = corners.iter().flat_map(|&c| [c, c + 0.1 * Vec3::X, c + 0.1 * Vec3::Y]);
    let triangles = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    MorphMesh::rigid("corners", positions.collect(), triangles.collect())
}

#[test]
fn a_node_has_a_child_for_every_octant_with_triangles() {
    let cube: Vec<Vec3> = (0..8)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32))
        .collect();
    let three = [cube[0], cube[3], cube[5]];
    for corners in [&cube[..], &three] {
        let body = Body::<Slabs<3>>::new(&welded(&in_corners(corners)), false);
        let root = Content::Children(1..1 + corners.len() as u32);
        assert_eq!(*body.tree.content(0), root);
        assert_eq!(body.tree.node_count(), 1 + corners.len());
    }
}

#[test]
fn triangles_in_one_place_are_dealt_out() {
    let body = Body::<Slabs<3>>::new(&welded(&in_corners(&[Vec3::ZERO; 20])), false);
    assert_eq!(*body.tree.content(0), Content::Children(1..8), "7 children of up to 3");
    assert_eq!(below(&body, 0).len(), 20);
}
