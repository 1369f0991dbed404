//! The walk over one tree.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
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

/// The nodes still to visit, lowest bound first. Later walks reuse the memory.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    /// At most [`Queue::FEW`] nodes, in descending order of their bounds. Rays rarely need more.
    few: Vec<Entry<Child>>,
    rest: BinaryHeap<Entry<Child>>,
}

impl Queue {
    const FEW: usize = 16;

    fn clear(&mut self) {
        self.few.clear();
        self.rest.clear();
    }

    #[inline(always)]
    fn push(&mut self, new: Entry<Child>) {
        let mut at = self.few.len();
        if at == Self::FEW {
            self.rest.push(new);
            return;
        }
        self.few.push(new);
        while at > 0 && self.few[at - 1].bound < new.bound {
            self.few[at] = self.few[at - 1];
            at -= 1;
        }
        self.few[at] = new;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Entry<Child>> {
        match (self.rest.peek(), self.few.last()) {
            (Some(rest), few) if few.is_none_or(|few| rest.bound < few.bound) => self.rest.pop(),
            _ => self.few.pop(),
        }
    }
}

/// Walks a posed tree best first: calls `at_leaf` for leaves in ascending order of their bounds, until a bound exceeds the limit
/// or `at_leaf` breaks.
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
    queue.clear();
    let mut group = 0;
    loop {
        let slot = tree.open(group);
        let children = tree.topology.group(group);
        *node_tests += children.children().len() as u64;
        let within = with_simd!(tree.level, simd => {
            bounds.lower_bounds(simd, tree.boxes(slot), children.mask(), limit, &mut lowest)
        });
        for lane in lanes_of(within) {
            let (bound, node) = (lowest[lane % LANES], children.child(lane));
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
                ChildKind::Leaf(leaf) => limit = at_leaf(tree, leaf)?,
                ChildKind::Group(group) => break group,
            }
        };
    }
}
