//! The walk over one tree.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use crate::bounds::{Keys, LANES, LowerBounds, lanes_of, with_simd};
use crate::pose::Posed;
use crate::tree::{Child, ChildKind, Leaf};

/// A node, or a pair of nodes, and its lower bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry<N> {
    pub(super) bound: f32,
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

/// The nodes still to visit, lowest bound first. Later walks reuse the memory.
#[derive(Debug)]
pub(crate) struct Queue {
    /// In descending order of their bounds. Rays rarely need more.
    few: [Entry<Child>; FEW],
    /// The number of entries of `few` that are in use.
    count: usize,
    rest: BinaryHeap<Entry<Child>>,
}

const FEW: usize = 16;

impl Default for Queue {
    fn default() -> Self {
        let (bound, node) = (0.0, Child::default());
        Self {
            few: [Entry { bound, node }; FEW],
            count: 0,
            rest: BinaryHeap::new(),
        }
    }
}

impl Queue {
    fn clear(&mut self) {
        self.count = 0;
        self.rest.clear();
    }

    #[inline(always)]
    fn push(&mut self, new: Entry<Child>) {
        if self.count == FEW {
            return self.push_full(new);
        }
        let mut at = self.count;
        self.count += 1;
        while at > 0 && self.few[(at - 1) % FEW].bound < new.bound {
            self.few[at % FEW] = self.few[(at - 1) % FEW];
            at -= 1;
        }
        self.few[at % FEW] = new;
    }

    /// Moves the greatest of the few and the new one to the rest.
    #[inline(never)]
    fn push_full(&mut self, new: Entry<Child>) {
        if new.bound >= self.few[0].bound {
            return self.rest.push(new);
        }
        self.rest.push(self.few[0]);
        let mut at = 1;
        while at < FEW && self.few[at].bound > new.bound {
            self.few[at - 1] = self.few[at];
            at += 1;
        }
        self.few[at - 1] = new;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Entry<Child>> {
        if self.count == 0 {
            return self.rest.pop();
        }
        let last = self.few[(self.count - 1) % FEW];
        if self.rest.peek().is_some_and(|rest| rest.bound < last.bound) {
            return self.rest.pop();
        }
        self.count -= 1;
        Some(last)
    }
}

/// Walks a posed tree best first: calls `at_leaf` for leaves in ascending order of their keys, until a key exceeds the limit or
/// `at_leaf` breaks.
///
/// `at_leaf` takes the limit, a key, and returns the new one. A break is passed on to the caller. Nodes that cannot contain an answer are not
/// opened, so nothing below them is blended. Adds the number of boxes tested to `node_tests`.
#[inline]
pub(crate) fn walk_one<'p>(
    tree: &mut Posed<'p>,
    queue: &mut Queue,
    mut limit: f32,
    bounds: &impl LowerBounds,
    node_tests: &mut u64,
    mut at_leaf: impl FnMut(&mut Posed<'p>, Leaf, f32) -> ControlFlow<(), f32>,
) -> ControlFlow<()> {
    let mut keys = Keys::default();
    queue.clear();
    let mut group = 0;
    loop {
        let slot = tree.open(group);
        let children = tree.topology.group(group);
        *node_tests += children.children().len() as u64;
        let within = with_simd!(tree.level, simd => {
            bounds.lower_bounds(simd, tree.boxes(slot), children.mask(), limit, &mut keys)
        });
        for lane in lanes_of(within) {
            let (bound, node) = (keys[lane % LANES], children.child(lane));
            queue.push(Entry { bound, node });
        }
        group = loop {
            let Some(Entry { bound, node }) = queue.pop() else {
                return ControlFlow::Continue(());
            };
            if bound > limit {
                return ControlFlow::Continue(());
            }
            match node.kind() {
                ChildKind::Leaf(leaf) => limit = at_leaf(tree, leaf, limit)?,
                ChildKind::Group(group) => break group,
            }
        };
    }
}
