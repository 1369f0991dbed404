//! The walk over a tree against itself.

use std::ops::ControlFlow;

use crate::bounds::{LANES, with_simd};
use crate::pose::{BoxTree, NodeRef};
use crate::tree::{ChildKind, Leaf};

/// The node pairs of one tree still to visit. Later walks reuse the memory.
pub(crate) type SelfStack = Vec<(NodeRef, NodeRef)>;

/// Calls `at_leaves` for every pair of leaves of a tree whose boxes overlap, and for each leaf with itself, until it
/// breaks. Returns the number of box tests.
///
/// Boxes are compared in the body's space, so no frames are needed.
pub(crate) fn walk_within<T: BoxTree>(
    tree: &mut T,
    stack: &mut SelfStack,
    mut at_leaves: impl FnMut(&mut T, Leaf, Leaf) -> ControlFlow<()>,
) -> u64 {
    let mut tests = 0;
    stack.clear();
    let root = tree.root();
    stack.push((root, root));
    while let Some((a, b)) = stack.pop() {
        match (a.child.kind(), b.child.kind()) {
            (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => {
                if at_leaves(tree, leaf_a, leaf_b).is_break() {
                    break;
                }
            }
            (ChildKind::Group(group), _) if a.child == b.child => tests += push_pairs_among(tree, group, stack),
            (ChildKind::Group(group), ChildKind::Leaf(_)) => tests += push_pairs_with(tree, group, b, stack),
            (ChildKind::Leaf(_), ChildKind::Group(group)) => tests += push_pairs_with(tree, group, a, stack),
            (ChildKind::Group(group_a), ChildKind::Group(group_b)) => {
                let a_is_larger = tree.node_box(a).girth() >= tree.node_box(b).girth();
                let (group, other) = if a_is_larger { (group_a, b) } else { (group_b, a) };
                tests += push_pairs_with(tree, group, other, stack);
            }
        }
    }
    tests
}

/// Pushes every child of a group with itself, and with every later child whose box overlaps its own.
fn push_pairs_among(tree: &mut impl BoxTree, group: usize, stack: &mut SelfStack) -> u64 {
    let slot = tree.open(group);
    let children = tree.topology().group(group).children().len();
    for lane in (0..children).rev() {
        let node = tree.node(slot, group, lane);
        let later = tree.topology().group(group).mask() & (u8::MAX << 1) << lane;
        let bounds = tree.node_box(node);
        let mask = with_simd!(tree.level(), simd => tree.boxes(slot).overlap_mask(simd, &bounds)) & later;
        stack.extend(lanes_reversed(mask).map(|other| (node, tree.node(slot, group, other))));
        stack.push((node, node));
    }
    (children * (children - 1) / 2) as u64
}

/// The lanes of a mask in descending order, so that the first lane is popped first.
fn lanes_reversed(mask: u8) -> impl Iterator<Item = usize> {
    (0..LANES).rev().filter(move |lane| mask >> lane & 1 == 1)
}

/// Pushes `other` with every child of a group whose box overlaps it.
fn push_pairs_with(tree: &mut impl BoxTree, group: usize, other: NodeRef, stack: &mut SelfStack) -> u64 {
    let bounds = tree.node_box(other);
    let slot = tree.open(group);
    let children = tree.topology().group(group).mask();
    let mask = with_simd!(tree.level(), simd => tree.boxes(slot).overlap_mask(simd, &bounds)) & children;
    stack.extend(lanes_reversed(mask).map(|lane| (tree.node(slot, group, lane), other)));
    u64::from(children.count_ones())
}
