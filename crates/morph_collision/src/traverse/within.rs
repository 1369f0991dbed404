//! The one walk over a tree and itself.

use std::ops::ControlFlow;

use super::pairs::lanes_of;
use crate::bounds::{LANES, Volume, with_simd};
use crate::pose::{NodeRef, Posed};
use crate::tree::{ChildKind, Leaf};

/// Node pairs of one tree still to be looked at; reused between walks.
pub(crate) type SelfStack = Vec<(NodeRef, NodeRef)>;

/// Calls `at_leaves` for every pair of leaves of a posed tree whose volumes share a point, each leaf with itself included,
/// until it breaks; returns how many volumes were tested against volumes.
///
/// Subtrees whose volumes are apart are culled. No frame is involved: both sides are in the same model space.
pub(crate) fn walk_within<V: Volume>(
    posed: &mut Posed<'_, V>,
    stack: &mut SelfStack,
    mut at_leaves: impl FnMut(&mut Posed<'_, V>, Leaf, Leaf) -> ControlFlow<()>,
) -> u64 {
    let mut tests = 0;
    stack.clear();
    let root = posed.root();
    stack.push((root, root));
    while let Some((a, b)) = stack.pop() {
        let flow = match (a.child.kind(), b.child.kind()) {
            (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => at_leaves(posed, leaf_a, leaf_b),
            (ChildKind::Group(group), _) if a.child == b.child => {
                tests += push_pairs_among(posed, group, stack);
                ControlFlow::Continue(())
            }
            (ChildKind::Group(group_a), ChildKind::Group(group_b)) => {
                let a_is_larger = V::size(&posed.volume(a)) >= V::size(&posed.volume(b));
                let (group, other) = if a_is_larger { (group_a, b) } else { (group_b, a) };
                tests += push_pairs_with(posed, group, other, stack);
                ControlFlow::Continue(())
            }
            (ChildKind::Group(group), ChildKind::Leaf(_)) => {
                tests += push_pairs_with(posed, group, b, stack);
                ControlFlow::Continue(())
            }
            (ChildKind::Leaf(_), ChildKind::Group(group)) => {
                tests += push_pairs_with(posed, group, a, stack);
                ControlFlow::Continue(())
            }
        };
        if flow.is_break() {
            break;
        }
    }
    tests
}

/// Every child of a group with itself, and with every later one that its volume shares a point with.
fn push_pairs_among<V: Volume>(posed: &mut Posed<'_, V>, group: usize, stack: &mut SelfStack) -> u64 {
    let slot = posed.open(group);
    let children = posed.topology.group(group).children().len();
    for lane in (0..children).rev() {
        let node = posed.node(slot, group, lane);
        let later = posed.topology.group(group).mask() & lanes_after(lane);
        let volume = posed.volume(node);
        let mask = with_simd!(posed.level, simd => posed.volumes(slot).overlap_mask(simd, &volume)) & later;
        stack.extend(lanes_of(mask).map(|other| (node, posed.node(slot, group, other))));
        stack.push((node, node));
    }
    (children * (children - 1) / 2) as u64
}

/// Every child of a group whose volume shares a point with another node's.
fn push_pairs_with<V: Volume>(posed: &mut Posed<'_, V>, group: usize, other: NodeRef, stack: &mut SelfStack) -> u64 {
    let volume = posed.volume(other);
    let slot = posed.open(group);
    let children = posed.topology.group(group).mask();
    let mask = with_simd!(posed.level, simd => posed.volumes(slot).overlap_mask(simd, &volume)) & children;
    stack.extend(lanes_of(mask).map(|lane| (posed.node(slot, group, lane), other)));
    u64::from(children.count_ones())
}

fn lanes_after(lane: usize) -> u8 {
    if lane + 1 == LANES { 0 } else { u8::MAX << (lane + 1) }
}
