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

/// A best-first walk over a posed tree. Blends no bounds below nodes that cannot hold an answer.
pub(crate) struct OneWalk<'a, 'p> {
    pub(crate) tree: &'a mut Posed<'p>,
    /// Nodes tested so far.
    pub(crate) node_tests: u64,
}

impl<'p> OneWalk<'_, 'p> {
    /// Calls `at_leaf` for leaves in ascending order of their bounds until the bounds exceed the limit or it breaks.
    ///
    /// `bound` maps a node's model-space box to a lower bound for its triangles (of their distance, say), `None` to skip the node.
    /// `at_leaf` returns the new limit.
    pub(crate) fn run(
        &mut self,
        queue: &mut Queue,
        mut limit: f64,
        mut bound: impl FnMut(&Aabb) -> Option<f64>,
        mut at_leaf: impl FnMut(&mut Posed<'p>, Leaf) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        queue.clear();
        let root = self.tree.root();
        self.enqueue(queue, root, limit, &mut bound);
        while let Some(Entry { bound: lowest, node }) = queue.pop() {
            if lowest > limit {
                break;
            }
            match node.child.kind() {
                ChildKind::Leaf(leaf) => limit = at_leaf(self.tree, leaf)?,
                ChildKind::Group(group) => {
                    let slot = self.tree.open(group);
                    for lane in 0..self.tree.topology.group(group).children().len() {
                        let child = self.tree.node(slot, group, lane);
                        self.enqueue(queue, child, limit, &mut bound);
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    #[inline]
    fn enqueue(&mut self, queue: &mut Queue, node: NodeRef, limit: f64, bound: &mut impl FnMut(&Aabb) -> Option<f64>) {
        self.node_tests += 1;
        let bounds = self.tree.node_box(node);
        if let Some(bound) = bound(&bounds)
            && bound <= limit
        {
            queue.push(Entry { bound, node });
        }
    }
}
