//! The walk over one tree.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use crate::bounds::{LANES, LowerBounds, with_simd};
use crate::pose::{NodeRef, Posed};
use crate::tree::{ChildKind, Leaf};

/// The nodes still to visit, lowest bound first. Later walks reuse the memory.
pub(crate) type Queue = BinaryHeap<Entry<NodeRef>>;

/// A node, or a pair of nodes, and its lower bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry<N> {
    pub(super) bound: f64,
    pub(super) node: N,
}

impl<N> Ord for Entry<N> {
    /// The heap pops the greatest entry: the one with the lowest bound.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

impl<N> PartialOrd for Entry<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<N> PartialEq for Entry<N> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<N> Eq for Entry<N> {}

/// Walks a posed tree best first: calls `at_leaf` for leaves in ascending order of their bounds, until a bound exceeds the limit
/// or `at_leaf` breaks.
///
/// `at_leaf` returns the new limit. A break is passed on to the caller. Nodes that cannot contain an answer are not opened, so
/// nothing below them is blended. Adds the number of boxes tested to `node_tests`.
pub(crate) fn walk_one<'p>(
    tree: &mut Posed<'p>,
    queue: &mut Queue,
    mut limit: f64,
    bounds: &impl LowerBounds,
    node_tests: &mut u64,
    mut at_leaf: impl FnMut(&mut Posed<'p>, Leaf) -> ControlFlow<(), f64>,
) -> ControlFlow<()> {
    let mut lowest = [0.0; LANES];
    let mut enqueue = |queue: &mut Queue, tree: &mut Posed<'p>, group, limit| {
        let slot = tree.open(group);
        let count = tree.topology.group(group).children().len();
        with_simd!(tree.level, simd => bounds.lower_bounds(simd, tree.boxes(slot), count, &mut lowest));
        for (lane, &bound) in lowest.iter().enumerate().take(count) {
            // False for NaN.
            if bound <= limit {
                queue.push(Entry {
                    bound,
                    node: tree.node(slot, group, lane),
                });
            }
        }
        count as u64
    };
    queue.clear();
    *node_tests += enqueue(queue, tree, 0, limit);
    while let Some(Entry { bound: lowest, node }) = queue.pop() {
        if lowest > limit {
            break;
        }
        match node.child.kind() {
            ChildKind::Leaf(leaf) => limit = at_leaf(tree, leaf)?,
            ChildKind::Group(group) => *node_tests += enqueue(queue, tree, group, limit),
        }
    }
    ControlFlow::Continue(())
}
