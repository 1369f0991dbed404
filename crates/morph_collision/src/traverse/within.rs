//! The walk over a tree against itself.

use std::ops::ControlFlow;

use crate::bounds::{LANES, with_simd};
use crate::pose::{NodeRef, Posed};
use crate::tree::{ChildKind, Leaf};

/// The node pairs of one tree still to visit. Later walks reuse the memory.
pub(crate) type SelfStack = Vec<(NodeRef, NodeRef)>;

/// Calls `at_leaves` for every pair of leaves of a posed tree whose boxes overlap, and for each leaf with itself, until it
/// breaks. Returns the number of box tests.
///
/// Boxes are compared in model space, so no frames are needed.
pub(crate) fn walk_within<'p>(
    posed: &mut Posed<'p>,
    stack: &mut SelfStack,
    mut at_leaves: impl FnMut(&mut Posed<'p>, Leaf, Leaf) -> ControlFlow<()>,
) -> u64 {
    let mut tests = 0;
    stack.clear();
    let root = posed.root();
    stack.push((root, root));
    while let Some((a, b)) = stack.pop() {
        match (a.child.kind(), b.child.kind()) {
            (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => {
                if at_leaves(posed, leaf_a, leaf_b).is_break() {
                    break;
                }
            }
            (ChildKind::Group(group), _) if a.child == b.child => tests += push_pairs_among(posed, group, stack),
            (ChildKind::Group(group), ChildKind::Leaf(_)) => tests += push_pairs_with(posed, group, b, stack),
            (ChildKind::Leaf(_), ChildKind::Group(group)) => tests += push_pairs_with(posed, group, a, stack),
            (ChildKind::Group(group_a), ChildKind::Group(group_b)) => {
                let a_is_larger = posed.node_box(a).girth() >= posed.node_box(b).girth();
                let (group, other) = if a_is_larger { (group_a, b) } else { (group_b, a) };
                tests += push_pairs_with(posed, group, other, stack);
            }
        }
    }
    tests
}

/// Pushes every child of a group with itself, and with every later child whose box overlaps its own.
fn push_pairs_among(posed: &mut Posed<'_>, group: usize, stack: &mut SelfStack) -> u64 {
    let slot = posed.open(group);
    let children = posed.topology.group(group).children().len();
    for lane in (0..children).rev() {
        let node = posed.node(slot, group, lane);
        let later = posed.topology.group(group).mask() & (u8::MAX << 1) << lane;
        let bounds = posed.node_box(node);
        let mask = with_simd!(posed.level, simd => posed.boxes(slot).overlap_mask(simd, &bounds)) & later;
        stack.extend(lanes_reversed(mask).map(|other| (node, posed.node(slot, group, other))));
        stack.push((node, node));
    }
    (children * (children - 1) / 2) as u64
}

/// The lanes of a mask in descending order, so that the first lane is popped first.
fn lanes_reversed(mask: u8) -> impl Iterator<Item = usize> {
    (0..LANES).rev().filter(move |lane| mask >> lane & 1 == 1)
}

/// Pushes `other` with every child of a group whose box overlaps it.
fn push_pairs_with(posed: &mut Posed<'_>, group: usize, other: NodeRef, stack: &mut SelfStack) -> u64 {
    let bounds = posed.node_box(other);
    let slot = posed.open(group);
    let children = posed.topology.group(group).mask();
    let mask = with_simd!(posed.level, simd => posed.boxes(slot).overlap_mask(simd, &bounds)) & children;
    stack.extend(lanes_reversed(mask).map(|lane| (posed.node(slot, group, lane), other)));
    u64::from(children.count_ones())
}
