//! The one walk over one tree.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use crate::bounds::Aabb;
use crate::pose::{NodeRef, Posed};
use crate::tree::{ChildKind, Leaf};

/// Nodes still to be looked at, lowest bound first; reused between walks.
pub(crate) type Queue = BinaryHeap<Entry>;

/// A node and the caller's lower bound on what it can give.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    bound: f64,
    node: NodeRef,
}

impl Ord for Entry {
    /// The greatest entry of a heap comes first: the one with the lowest bound.
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

/// A walk over the nodes of a posed tree, best first: no node's box is blended that could not hold an answer.
pub(crate) struct OneWalk<'a, 'p> {
    pub(crate) tree: &'a mut Posed<'p>,
    /// Nodes bounded so far.
    pub(crate) node_tests: u64,
}

impl<'p> OneWalk<'_, 'p> {
    /// Calls `at_leaf` for leaves by ascending bound, as long as that is at most the limit, until it breaks.
    ///
    /// `bound` is given a node's model-space box, and says what its triangles give at least (their distance, say), or
    /// `None` where they give nothing. `at_leaf` returns the new limit.
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
