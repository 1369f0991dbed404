//! The walk over two trees that visits the nearest nodes first.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use crate::bounds::Aabb;
use crate::pose::{NodeRef, Posed};
use crate::tree::{ChildKind, Leaf};

/// The node pairs still to visit, with their lower bounds. Later walks reuse the memory.
pub(crate) type NearestStack = Vec<(f64, NodeRef, NodeRef)>;

/// Calls `at_leaves` for pairs of leaves whose lower bound is at most the limit, until it breaks. Returns the number of node
/// pairs tested.
///
/// `bound` takes the model-space boxes of one node of each body and returns a lower bound for their triangles (for example of
/// their distance). `at_leaves` returns the new limit. The walk opens the larger node and visits its children in ascending
/// order of their bounds. `a_from_b_scale` converts lengths in B's units to A's, to compare sizes.
pub(crate) fn walk_nearest<'p>(
    a: &mut Posed<'p>,
    b: &mut Posed<'p>,
    a_from_b_scale: f32,
    stack: &mut NearestStack,
    mut limit: f64,
    bound: impl Fn(&Aabb, &Aabb) -> f64,
    mut at_leaves: impl FnMut(&mut Posed<'p>, &mut Posed<'p>, Leaf, Leaf) -> ControlFlow<(), f64>,
) -> u64 {
    stack.clear();
    let mut tests = 0;
    let mut push =
        |stack: &mut NearestStack, limit: f64, (a, node_a): (&Posed<'p>, _), (b, node_b): (&Posed<'p>, _)| {
            tests += 1;
            let lowest = bound(&a.node_box(node_a), &b.node_box(node_b));
            if lowest <= limit {
                stack.push((lowest, node_a, node_b));
            }
        };
    let (root_a, root_b) = (a.root(), b.root());
    push(stack, limit, (a, root_a), (b, root_b));
    while let Some((lowest, node_a, node_b)) = stack.pop() {
        if lowest > limit {
            continue;
        }
        let a_is_larger = || a.node_box(node_a).girth() >= b.node_box(node_b).girth() * a_from_b_scale;
        let first = stack.len();
        match (node_a.child.kind(), node_b.child.kind()) {
            (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => match at_leaves(a, b, leaf_a, leaf_b) {
                ControlFlow::Continue(lower) => limit = lower,
                ControlFlow::Break(()) => break,
            },
            (ChildKind::Group(group), other) if matches!(other, ChildKind::Leaf(_)) || a_is_larger() => {
                let slot = a.open(group);
                for lane in (0..a.topology.group(group).children().len()).rev() {
                    push(stack, limit, (a, a.node(slot, group, lane)), (b, node_b));
                }
            }
            (_, ChildKind::Group(group)) => {
                let slot = b.open(group);
                for lane in (0..b.topology.group(group).children().len()).rev() {
                    push(stack, limit, (a, node_a), (b, b.node(slot, group, lane)));
                }
            }
            (ChildKind::Group(_), ChildKind::Leaf(_)) => {}
        }
        // The nearest pair is popped first; among equals, the first lane.
        stack[first..].sort_by(|x, y| y.0.partial_cmp(&x.0).unwrap_or(Ordering::Equal));
    }
    tests
}
