//! The walk over one tree.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use crate::bounds::{LANES, LowerBounds, lanes_of, with_simd};
use crate::pose::Posed;
use crate::tree::{Child, ChildKind, Leaf};

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

/// The nodes still to visit. Later walks reuse the memory.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    /// In descending order of their bounds, except as [`Queue::push`] says.
    waiting: Vec<Waiting>,
}

#[derive(Clone, Copy, Debug)]
struct Waiting {
    bound: f64,
    node: Child,
}

impl Queue {
    /// Most of the time, few nodes wait, and a new one is among the nearest. If very many wait, a far one may be visited early, so
    /// that no node costs more than this many steps.
    const MOST_STEPS: usize = 128;

    #[inline(always)]
    fn push(&mut self, new: Waiting) {
        let mut at = self.waiting.len();
        self.waiting.push(new);
        let last = at.saturating_sub(Self::MOST_STEPS);
        while at > last && self.waiting[at - 1].bound < new.bound {
            self.waiting[at] = self.waiting[at - 1];
            at -= 1;
        }
        self.waiting[at] = new;
    }
}

/// Walks a posed tree best first: calls `at_leaf` for leaves in ascending order of their bounds, until all bounds exceed the limit
/// or `at_leaf` breaks. If more than a hundred nodes wait, the order is only roughly ascending.
///
/// `at_leaf` returns the new limit. A break is passed on to the caller. Nodes that cannot contain an answer are not opened, so
/// nothing below them is blended. Adds the number of boxes tested to `node_tests`.
#[inline]
pub(crate) fn walk_one<'p>(
    tree: &mut Posed<'p>,
    queue: &mut Queue,
    mut limit: f64,
    bounds: &impl LowerBounds,
    node_tests: &mut u64,
    mut at_leaf: impl FnMut(&mut Posed<'p>, Leaf) -> ControlFlow<(), f64>,
) -> ControlFlow<()> {
    let mut lowest = [0.0; LANES];
    queue.waiting.clear();
    let mut group = 0;
    loop {
        let slot = tree.open(group);
        let within = with_simd!(tree.level, simd => bounds.lower_bounds(simd, tree.boxes(slot), limit, &mut lowest));
        let children = tree.topology.group(group);
        *node_tests += children.children().len() as u64;
        for lane in lanes_of(within & children.mask()) {
            let (bound, node) = (lowest[lane % LANES], children.child(lane));
            queue.push(Waiting { bound, node });
        }
        group = loop {
            let Some(Waiting { bound, node }) = queue.waiting.pop() else {
                return ControlFlow::Continue(());
            };
            if bound > limit {
                continue;
            }
            match node.kind() {
                ChildKind::Leaf(leaf) => limit = at_leaf(tree, leaf)?,
                ChildKind::Group(group) => break group,
            }
        };
    }
}
