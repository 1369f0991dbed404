//! Bodies for the tests of the walks, and access to their leaves.

use std::sync::Arc;

use glam::Vec3;
use morph_collision_models::generated::random::random_blob;

use crate::bounds::Aabb;
use crate::model::MorphModel;
use crate::pose::{NodeRef, Pose, Posed};
use crate::tree::{BuildOptions, ChildKind, Leaf, MorphBvh};

fn rigid(positions: &[Vec3], triangles: &[[u32; 3]]) -> Pose {
    let model = MorphModel::from_displacements::<[Vec3; 0]>(positions, triangles, &[]).unwrap();
    let one_a_leaf = BuildOptions::default().with_leaf_size(1).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &one_a_leaf)))
}

/// One triangle per cube, whose bounds are the cube. `places` are the cubes' lowest corners. Each triangle is a leaf.
pub(super) fn cubes(places: &[Vec3], size: f32) -> Pose {
    let across = [Vec3::ZERO, Vec3::X, Vec3::ONE].map(|corner| corner * size);
    let positions: Vec<_> = places.iter().flat_map(|place| across.map(|p| *place + p)).collect();
    let triangles: Vec<_> = (0..places.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    rigid(&positions, &triangles)
}

/// Unit cubes along the x axis.
pub(super) fn row(places: &[f32]) -> Pose {
    let places: Vec<_> = places.iter().map(|x| Vec3::X * *x).collect();
    cubes(&places, 1.0)
}

/// A closed surface of 320 triangles around a point. Each triangle is a leaf.
pub(super) fn blob(place: Vec3, radius: f32) -> Pose {
    let mesh = random_blob(1, 2, 0, 0.0);
    let positions: Vec<_> = mesh.positions.iter().map(|p| place + radius * *p).collect();
    rigid(&positions, &mesh.triangles)
}

/// The only triangle of a leaf.
pub(super) fn triangle(posed: &Posed<'_>, leaf: Leaf) -> u32 {
    posed.topology.leaf_triangles(leaf)[0]
}

/// The triangle and the box of each leaf.
pub(super) fn leaves(posed: &mut Posed<'_>) -> Vec<(u32, Aabb)> {
    fn below(posed: &mut Posed<'_>, node: NodeRef, found: &mut Vec<(u32, Aabb)>) {
        match node.child.kind() {
            ChildKind::Leaf(leaf) => found.push((triangle(posed, leaf), posed.node_box(node))),
            ChildKind::Group(group) => {
                let slot = posed.open(group);
                for lane in 0..posed.topology.group(group).children().len() {
                    below(posed, posed.node(slot, group, lane), found);
                }
            }
        }
    }
    let mut found = Vec::new();
    let root = posed.root();
    below(posed, root, &mut found);
    found
}
