//! The walk over one tree.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use crate::bounds::Aabb;
use crate::pose::{NodeRef, Posed};
use crate::tree::{ChildKind, Leaf};

/// The nodes still to visit, lowest bound first. Walks reuse the memory.
pub(crate) type Queue = BinaryHeap<Entry>;

/// A node and its lower bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    bound: f64,
    node: NodeRef,
}

impl Ord for Entry {
    /// The heap pops the greatest entry: the one with the lowest bound.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// Walks a posed tree best first: calls `at_leaf` for leaves in ascending order of their bounds until the bounds exceed the limit or
/// it breaks, which it passes on. Blends no bounds below nodes that cannot hold an answer.
///
/// `bound` maps a node's model-space box to a lower bound for its triangles (of their distance, say), `None` to skip the node; it is
/// called once for each node tested. `at_leaf` returns the new limit.
pub(crate) fn walk_one<'p>(
    tree: &mut Posed<'p>,
    queue: &mut Queue,
    mut limit: f64,
    mut bound: impl FnMut(&Aabb) -> Option<f64>,
    mut at_leaf: impl FnMut(&mut Posed<'p>, Leaf) -> ControlFlow<(), f64>,
) -> ControlFlow<()> {
    let mut enqueue = |queue: &mut Queue, tree: &Posed<'p>, node, limit| {
        let bound = bound(&tree.node_box(node)).filter(|&bound| bound <= limit);
        queue.extend(bound.map(|bound| Entry { bound, node }));
    };
    queue.clear();
    let root = tree.root();
    enqueue(queue, tree, root, limit);
    while let Some(Entry { bound: lowest, node }) = queue.pop() {
        if lowest > limit {
            break;
        }
        match node.child.kind() {
            ChildKind::Leaf(leaf) => limit = at_leaf(tree, leaf)?,
            ChildKind::Group(group) => {
                let slot = tree.open(group);
                for lane in 0..tree.topology.group(group).children().len() {
                    enqueue(queue, tree, tree.node(slot, group, lane), limit);
                }
            }
        }
    }
    ControlFlow::Continue(())
}
