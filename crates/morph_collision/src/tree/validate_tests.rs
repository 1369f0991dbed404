//! Checks the invariants that the code of the tree relies on.

use super::{ChildKind, MorphBvh};
use crate::bounds::LANES;

/// Checks that groups and leaves are in preorder, that every triangle is in exactly one leaf, that no leaf exceeds the leaf size,
/// and that all numbers in the tables are finite.
///
/// # Panics
/// If the tree is broken; the message says where.
pub(super) fn validate(bvh: &MorphBvh) {
    let topology = &bvh.topology;
    let (mut next_group, mut next_leaf) = (1, 0);
    let mut triangles: Vec<u32> = Vec::new();
    let mut rest: Vec<ChildKind> = topology.group(0).children().iter().map(|root| root.kind()).collect();
    assert_eq!(rest.len(), 1, "group 0 has the root alone");
    while let Some(node) = rest.pop() {
        match node {
            ChildKind::Group(group) => {
                assert_eq!(group, next_group, "groups in preorder");
                next_group += 1;
                let children = topology.group(group).children();
                assert!(
                    (2..=LANES).contains(&children.len()),
                    "group {group} has {} children",
                    children.len()
                );
                rest.extend(children.iter().rev().map(|child| child.kind()));
            }
            ChildKind::Leaf(leaf) => {
                assert_eq!(leaf.0, next_leaf, "leaves in preorder");
                next_leaf += 1;
                let mesh = topology.leaf_mesh(leaf);
                assert!(
                    (1..=bvh.options().leaf_size()).contains(&mesh.corners.len()),
                    "leaf {leaf:?}"
                );
                for (&triangle, corners) in topology.leaf_triangles(leaf).iter().zip(mesh.corners) {
                    let corners = corners.map(|corner| mesh.vertices[usize::from(corner)]);
                    assert_eq!(bvh.model().triangle(triangle), Some(corners), "leaf {leaf:?}");
                }
                triangles.extend(topology.leaf_triangles(leaf));
            }
        }
    }
    assert_eq!((next_group, next_leaf), (topology.group_count(), topology.leaf_count()));
    triangles.sort_unstable();
    assert!(
        triangles.into_iter().eq(0..bvh.model().triangle_count() as u32),
        "each triangle once"
    );
    for group in 0..topology.group_count() {
        let tables = bvh.tables.group(group);
        let base = tables.base.min.iter().chain(&tables.base.max).flat_map(|row| row.0);
        let intervals = tables
            .intervals
            .iter()
            .flat_map(|word| [word & 0xffff_0000, word << 16]);
        let slopes = tables.references.iter().copied().chain(intervals.map(f32::from_bits));
        assert!(slopes.chain(base).all(f32::is_finite), "the tables of group {group}");
    }
}
