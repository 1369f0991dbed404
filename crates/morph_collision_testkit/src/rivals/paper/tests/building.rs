//! The shape of trees.

use glam::Vec3;

use super::super::body::Body;
use super::super::references::References;
use super::super::slabs::Slabs;
use super::super::sphere::Sphere;
use super::super::tree::{Content, Tree};
use super::super::volume::Volume;
use super::super::{PaperOptions, PaperVolume};
use super::{below, meshes, welded};
use morph_collision_models::generated::{self, dolphin, random};
use morph_collision_models::mesh::MorphMesh;

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

fn bytes_are_bounded<V: Volume>(volume: PaperVolume) {
    for mesh in [
        random::random_blob(3, 4, 20, 0.9),
        random::random_blob(4, 3, 40, 0.0),
        random::triangle_soup(11, 500, 8),
        dolphin(1),
        generated::rigid::box_mesh(Vec3::ONE),
    ] {
        for in_betweens in [false, true] {
            let options = PaperOptions { volume, in_betweens };
            let tree = Tree::<V>::build(&References::new(&welded(&mesh)), in_betweens);
            // While a list grows it exists twice for a moment; the old one is half as large.
            let (bytes, most) = (tree.bytes() as u64 * 3 / 2, options.tree_bytes(&mesh));
            assert!(bytes <= most, "{options:?}, {}: {bytes} of {most}", mesh.name);
            assert!(most <= bytes * 20, "{options:?}, {}: {bytes} of {most}", mesh.name);
        }
    }
}

#[test]
fn a_tree_takes_no_more_than_is_said_beforehand() {
    bytes_are_bounded::<Slabs<3>>(PaperVolume::Aabb);
    bytes_are_bounded::<Slabs<7>>(PaperVolume::Kdop14);
    bytes_are_bounded::<Slabs<9>>(PaperVolume::Kdop18);
    bytes_are_bounded::<Slabs<13>>(PaperVolume::Kdop26);
    bytes_are_bounded::<Sphere>(PaperVolume::Sphere);
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
