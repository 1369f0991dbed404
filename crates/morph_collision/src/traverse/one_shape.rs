//! The walk over one tree.

use std::cell::Cell;
use std::ops::ControlFlow;

use crate::bounds::{Aabb, Volume};
use crate::pose::{NodeRef, Posed};
use crate::tree::{ChildKind, Leaf};

/// Nodes still to be looked at, each with its rank; reused between walks.
pub(crate) type RankedStack = Vec<(f64, NodeRef)>;

/// Calls `at_leaf` for every leaf that may hold something of rank at most `limit`, until it breaks; of a group's children the
/// lowest first.
///
/// `rank` gives a lower bound for all that is in a node from its box in model space. `at_leaf` may lower the limit. Returns
/// how many boxes were ranked.
pub(crate) fn walk<V: Volume>(
    posed: &mut Posed<'_, V>,
    stack: &mut RankedStack,
    limit: &Cell<f64>,
    rank: impl Fn(&Aabb) -> f64,
    mut at_leaf: impl FnMut(&mut Posed<'_, V>, Leaf) -> ControlFlow<()>,
) -> u64 {
    stack.clear();
    let root = posed.root();
    stack.push((rank(&V::bounds(&posed.volume(root))), root));
    let mut node_tests = 1;
    while let Some((bound, node)) = stack.pop() {
        // Something better may have been found since it was pushed.
        if bound > limit.get() {
            continue;
        }
        let group = match node.child.kind() {
            ChildKind::Leaf(leaf) => {
                if at_leaf(posed, leaf).is_break() {
                    break;
                }
                continue;
            }
            ChildKind::Group(group) => group,
        };
        let slot = posed.open(group);
        let first = stack.len();
        for lane in 0..posed.topology.group(group).children().len() {
            let bound = rank(&V::bounds(&posed.volumes(slot).get(lane)));
            node_tests += 1;
            if bound <= limit.get() {
                stack.push((bound, posed.node(slot, group, lane)));
            }
        }
        stack[first..].sort_by(|(a, _), (b, _)| b.total_cmp(a));
    }
    node_tests
}
