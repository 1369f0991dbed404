//! The walk over a tree against itself.

use std::ops::ControlFlow;

use crate::bounds::{Aabb, LANES, with_simd};
use crate::pose::{BoxTree, NodeRef};
use crate::tree::{Apart, ChildKind, Leaf};

/// The node pairs of one tree still to visit. Later walks reuse the memory.
pub(crate) type SelfStack = Vec<(NodeRef, NodeRef)>;

/// Calls `at_leaves` for every pair of leaves below the given pairs of nodes whose boxes overlap, until it breaks, or after more than
/// `most` box tests. Returns the number of box tests.
///
/// Boxes are compared in the body's space, so no frames are needed.
pub(crate) fn walk_within<T: BoxTree>(
    tree: &mut T,
    front: &[Apart],
    stack: &mut SelfStack,
    most: u64,
    at_leaves: impl FnMut(&mut T, Leaf, Leaf) -> ControlFlow<()>,
) -> u64 {
    walk_near(tree, front, stack, most, |bounds| bounds, at_leaves)
}

/// Like [`walk_within`], for boxes that overlap after one of the two is enlarged by `enlarge`.
pub(crate) fn walk_near<T: BoxTree>(
    tree: &mut T,
    front: &[Apart],
    stack: &mut SelfStack,
    most: u64,
    enlarge: impl Fn(Aabb) -> Aabb,
    mut at_leaves: impl FnMut(&mut T, Leaf, Leaf) -> ControlFlow<()>,
) -> u64 {
    let mut tests = 0;
    stack.clear();
    for step in front {
        let (above, lane) = (step.node.group as usize, usize::from(step.node.lane));
        let slot = tree.open(above);
        let node = tree.node(slot, above, lane);
        tests += push_pairs_with(tree, step.group as usize, step.mask, node, &enlarge, stack);
        while let Some((a, b)) = stack.pop() {
            let (group, other) = match (a.child.kind(), b.child.kind()) {
                (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => {
                    if at_leaves(tree, leaf_a, leaf_b).is_break() {
                        return tests;
                    }
                    continue;
                }
                (ChildKind::Group(group), ChildKind::Leaf(_)) => (group, b),
                (ChildKind::Leaf(_), ChildKind::Group(group)) => (group, a),
                (ChildKind::Group(group_a), ChildKind::Group(group_b)) => {
                    let a_is_larger = tree.node_box(a).girth() >= tree.node_box(b).girth();
                    if a_is_larger { (group_a, b) } else { (group_b, a) }
                }
            };
            tests += push_pairs_with(tree, group, u8::MAX, other, &enlarge, stack);
            if tests > most {
                return tests;
            }
        }
    }
    tests
}

/// Pushes `other` with every child of a group in `mask` whose box overlaps its enlarged box.
#[inline(always)]
fn push_pairs_with(
    tree: &mut impl BoxTree,
    group: usize,
    mask: u8,
    other: NodeRef,
    enlarge: impl Fn(Aabb) -> Aabb,
    stack: &mut SelfStack,
) -> u64 {
    let bounds = enlarge(tree.node_box(other));
    let slot = tree.open(group);
    let children = tree.topology().group(group).mask() & mask;
    let mask = with_simd!(tree.level(), simd => tree.boxes(slot).overlap_mask(simd, &bounds)) & children;
    // In descending order, so that the first lane is popped first.
    let overlapping = (0..LANES).rev().filter(|lane| mask >> lane & 1 == 1);
    if mask != 0 {
        stack.extend(overlapping.map(|lane| (tree.node(slot, group, lane), other)));
    }
    u64::from(children.count_ones())
}
