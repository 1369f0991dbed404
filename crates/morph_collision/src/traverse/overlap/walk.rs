//! The walk over two trees that finds the leaves whose boxes overlap.

use std::cell::Cell;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::depth_sort::DepthSort;
use super::mapped_boxes::MappedBoxes;
use super::node::{BoxAt, Node, NodePair};
use super::trees::Trees;
use crate::bounds::{Aabb, FrameLanes, LANES, lanes_of, with_simd};
use crate::pose::{BoxTree, PlacedBody};
use crate::traverse::one_tree::Entry;
use crate::tree::{ChildKind, Leaf, NodeId};

/// Nodes whose sizes differ by less than this factor are opened together. Chosen by instruction counts on the bench scenes
/// (docs/tried.md).
const MAX_SIZE_RATIO: f32 = 3.0;

/// Leaf pairs are passed on in batches of about this many. Not measured; the list stays short, and the cost of a call is spread
/// over many pairs.
pub(super) const LEAF_PAIRS: usize = 256;

/// The order in which node pairs are visited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order<'w> {
    /// Any fixed order. Leaf pairs are passed on many at a time.
    Any,
    /// The children that overlap deepest come first, and leaf pairs are passed on one at a time. Worth it if the walk ends at the
    /// first intersection.
    DeepestFirst,
    /// Best first: pairs of boxes that overlap early in a motion come first, and leaf pairs are passed on one at a time. Pairs that overlap
    /// only later than this time are skipped. The caller may lower it during the walk. For boxes that move.
    EarliestFirst(&'w Cell<f64>),
    /// Like [`Order::Any`], but leaf pairs stay on the stack.
    Expand,
}

/// The callback for pairs of leaves.
pub(crate) type AtLeaves<'v, T> = dyn FnMut(&mut T, &mut T, &[(Leaf, Leaf)]) -> ControlFlow<()> + 'v;

/// A depth-first walk over the node pairs of two bodies whose boxes overlap in every frame. The next walk reuses the memory.
///
/// Opens the larger node and tests its children against the other node, eight at once (the paper's Sect. 3: descend the larger).
/// Opens both nodes if their sizes are similar.
#[derive(Debug, Default)]
pub(crate) struct OverlapWalk {
    a: MappedBoxes,
    b: MappedBoxes,
    /// The node pairs still to visit.
    stack: Vec<NodePair>,
    /// The same for [`Order::EarliestFirst`], with lower bounds of the times at which their boxes overlap. Its stack has those of which the
    /// bound is not lower than that of the last one from the queue.
    queue: BinaryHeap<Entry<NodePair>>,
    /// Such bounds for the lanes that were compared last.
    enter: [f32; LANES],
    leaves: Vec<(Leaf, Leaf)>,
    by_depth: DepthSort,
    /// Node bounds tested so far.
    pub(crate) node_tests: u64,
    /// The walk breaks when it has tested more. See [`OverlapWalk::limit`].
    most: u64,
    is_cut: bool,
    /// The bound of the node pair that was visited last by [`Order::EarliestFirst`].
    bound: f64,
}

/// More waiting node pairs than this take more than 16 MB. While so many are waiting, what is below the earliest one is visited at once.
const MOST_WAITING: usize = 1 << 18;

impl OverlapWalk {
    /// Makes the next walk break after about `most` tests of nodes. Returns the number of tests so far.
    pub(crate) fn limit(&mut self, most: u64) -> u64 {
        self.most = self.node_tests.saturating_add(most);
        self.node_tests
    }

    /// Whether the last walk broke because of its limit.
    pub(crate) fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// After a walk by [`Order::EarliestFirst`] that broke: no pair of nodes that was not visited overlaps earlier.
    pub(crate) fn bound(&self) -> f64 {
        self.bound
    }

    /// Starts a query, without frames. `a_from_b_scale` converts lengths in B's units to A's, to compare sizes.
    pub(crate) fn begin(&mut self, [a, b]: [&PlacedBody; 2], a_from_b_scale: f32) {
        self.most = u64::MAX;
        self.is_cut = false;
        self.a.begin(a, 1.0);
        self.b.begin(b, a_from_b_scale);
    }

    /// Adds a frame and returns whether the bodies' bounds overlap in it. If all frames are in use, replaces the last one.
    #[inline(always)]
    pub(crate) fn push_frame<S: Simd>(
        &mut self,
        simd: S,
        [of_a, of_b]: [Option<&FrameLanes<S>>; 2],
        a: &Aabb,
        b: &Aabb,
    ) -> bool {
        let (a, b) = (self.a.push_frame(simd, of_a, a), self.b.push_frame(simd, of_b, b));
        a.overlaps(&b)
    }

    /// Calls `at_leaves` for all pairs of leaves whose boxes overlap, until it breaks.
    ///
    /// Starts at the node pairs in `front`. If it is empty, starts at the roots, which the caller has tested already.
    pub(crate) fn run<T: BoxTree>(
        &mut self,
        a: &mut T,
        b: &mut T,
        front: &[(NodeId, NodeId)],
        order: Order<'_>,
        at_leaves: &mut AtLeaves<'_, T>,
    ) -> ControlFlow<()> {
        with_simd!(a.level(), simd => self.walk(simd, Trees { a, b }, front, order, at_leaves))
    }

    /// Expands the roots, level by level, into at least `least` node pairs (fewer if there are not that many), in the order of
    /// the walk.
    pub(crate) fn front<T: BoxTree>(&mut self, a: &mut T, b: &mut T, least: usize) -> Vec<(NodeId, NodeId)> {
        let mut front = vec![(NodeId::ROOT, NodeId::ROOT)];
        let mut done = false;
        while front.len() < least && !done {
            let mut next = Vec::new();
            done = true;
            for (id_a, id_b) in front {
                let pair = NodePair {
                    a: self.a.node(a, id_a),
                    b: self.b.node(b, id_b),
                };
                if pair.are_leaves() {
                    next.push((id_a, id_b));
                    continue;
                }
                done = false;
                self.stack.clear();
                let trees = &mut Trees { a: &mut *a, b: &mut *b };
                with_simd!(trees.a.level(), simd => self.descend(simd, trees, pair, Order::Expand));
                // The order of the walk: first leaf pairs in the order they were pushed, then all other pairs in reverse.
                let (leaves, nodes): (Vec<_>, Vec<_>) = self.stack.drain(..).partition(|pair| pair.are_leaves());
                let in_order = leaves.into_iter().chain(nodes.into_iter().rev());
                next.extend(in_order.map(|pair| (self.a.id(pair.a), self.b.id(pair.b))));
            }
            front = next;
        }
        front
    }

    /// The loop of the walk:
    ///
    /// ```text
    /// for each pair of nodes in the front whose boxes overlap:
    ///     push it
    ///     while a pair is left, take the next one in the given order:
    ///         both are leaves              -> pass them on, many at a time or one by one
    ///         B is a leaf or A is larger   -> push A's children that overlap B, each with B
    ///         A is a leaf or B is larger   -> push B's children that overlap A, each with A
    ///         they are about equally large -> for each child of A that overlaps B, push B's children that overlap it, each with it
    /// ```
    ///
    /// Boxes are compared in every frame, eight at once; those that overlap there again in time if they move ([`MappedBoxes::meet`]).
    #[inline(always)]
    fn walk<S: Simd, T: BoxTree>(
        &mut self,
        simd: S,
        mut trees: Trees<'_, T>,
        front: &[(NodeId, NodeId)],
        order: Order<'_>,
        at_leaves: &mut AtLeaves<'_, T>,
    ) -> ControlFlow<()> {
        let trees = &mut trees;
        self.stack.clear();
        self.queue.clear();
        self.leaves.clear();
        if T::MOVES {
            self.a.begin_moving(trees.a);
            self.b.begin_moving(trees.b);
        }
        let roots = [(NodeId::ROOT, NodeId::ROOT)];
        for (id_a, id_b) in if front.is_empty() { &roots } else { front } {
            let pair = NodePair {
                a: self.a.node(trees.a, *id_a),
                b: self.b.node(trees.b, *id_b),
            };
            self.node_tests += 1;
            let overlap = || {
                let of_b = self.b.group_of(pair.b);
                self.a
                    .group_of(pair.a)
                    .overlaps(simd, of_b, pair.b.lane(), self.a.frames())
            };
            if !front.is_empty() && overlap() >> pair.a.lane() & 1 == 0 {
                continue;
            }
            self.enter[0] = 0.0;
            self.push(pair, 0, order);
            while let Some(pair) = self.next(order) {
                if self.node_tests > self.most {
                    self.is_cut = true;
                    return ControlFlow::Break(());
                }
                match (pair.a.child.kind(), pair.b.child.kind()) {
                    (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => self.leaves.push((leaf_a, leaf_b)),
                    _ => self.descend(simd, trees, pair, order),
                }
                let is_one_by_one = matches!(order, Order::DeepestFirst | Order::EarliestFirst(_));
                if self.leaves.len() >= LEAF_PAIRS || is_one_by_one && !self.leaves.is_empty() {
                    at_leaves(trees.a, trees.b, &self.leaves)?;
                    self.leaves.clear();
                }
            }
        }
        if self.leaves.is_empty() {
            return ControlFlow::Continue(());
        }
        at_leaves(trees.a, trees.b, &self.leaves)
    }

    /// Pushes the overlapping pairs below two nodes, at least one of which is not a leaf.
    #[inline(always)]
    fn descend<S: Simd, T: BoxTree>(&mut self, simd: S, trees: &mut Trees<'_, T>, pair: NodePair, order: Order<'_>) {
        let NodePair { a: node_a, b: node_b } = pair;
        // Whether a node is so much larger than the other that only it is opened.
        let dominates = |own: f32, other: f32| own >= MAX_SIZE_RATIO * other;
        let first = self.stack.len();
        self.by_depth.clear();
        match (node_a.child.kind(), node_b.child.kind()) {
            (ChildKind::Group(group), _)
                if node_b.child.is_leaf() || dominates(self.a.size(node_a), self.b.size(node_b)) =>
            {
                let slot = self.a.open(trees.a, group);
                let rows = self.rows::<S, T>(simd, slot, node_b);
                if order == Order::DeepestFirst && rows.count_ones() > 1 {
                    let depths = self.a.group(slot).depths(simd, self.b.group_of(node_b), node_b.lane());
                    self.by_depth.add(rows, &depths);
                }
                for lane in lanes_of(rows) {
                    let pair = NodePair {
                        a: self.a.child(slot, lane),
                        b: node_b,
                    };
                    self.push(pair, lane, order);
                }
            }
            (kind, ChildKind::Group(group_b)) => {
                // Opening both takes as many tests as opening one after the other, but one step of the walk.
                let (slot_a, rows) = match kind {
                    ChildKind::Group(group_a) if !dominates(self.b.size(node_b), self.a.size(node_a)) => {
                        let slot = self.a.open(trees.a, group_a);
                        (slot, self.rows::<S, T>(simd, slot, node_b))
                    }
                    _ => (node_a.slot(), 1 << node_a.lane()),
                };
                if rows != 0 {
                    let slot_b = self.b.open(trees.b, group_b);
                    for row in lanes_of(rows) {
                        let at_a = BoxAt {
                            slot: slot_a,
                            lane: row,
                        };
                        self.descend_row::<S, T>(simd, at_a, slot_b, order);
                    }
                }
            }
            (_, ChildKind::Leaf(_)) => {}
        }
        if order == Order::DeepestFirst && self.stack.len() > first + 1 {
            self.by_depth.sort(&mut self.stack[first..]);
        }
    }

    /// The children in a slot of A that overlap a node of B.
    #[inline(always)]
    fn rows<S: Simd, T: BoxTree>(&mut self, simd: S, slot: usize, node_b: Node) -> u8 {
        let (group, other, lane) = (self.a.group(slot), self.b.group_of(node_b), node_b.lane());
        self.node_tests += u64::from(group.len);
        let mut mask = group.overlaps(simd, other, lane, self.a.frames());
        if T::MOVES && mask != 0 {
            mask &= self.a.meet(simd, slot, &self.b, node_b.box_at(), &mut self.enter);
        }
        mask
    }

    /// Pushes the children in a slot of B that overlap a child of A.
    #[inline(always)]
    fn descend_row<S: Simd, T: BoxTree>(&mut self, simd: S, at_a: BoxAt, slot_b: usize, order: Order<'_>) {
        let (group_a, group_b) = (self.a.group(at_a.slot), self.b.group(slot_b));
        self.node_tests += u64::from(group_b.len);
        let mut mask = group_b.overlaps(simd, group_a, at_a.lane, self.b.frames());
        if T::MOVES && mask != 0 {
            mask &= self.b.meet(simd, slot_b, &self.a, at_a, &mut self.enter);
        }
        if mask == 0 {
            return;
        }
        if order == Order::DeepestFirst {
            self.by_depth.add(mask, &group_b.depths(simd, group_a, at_a.lane));
        }
        let node_a = self.a.child(at_a.slot, at_a.lane);
        for lane in lanes_of(mask) {
            let pair = NodePair {
                a: node_a,
                b: self.b.child(slot_b, lane),
            };
            self.push(pair, lane, order);
        }
    }

    /// Adds a pair of nodes, one of which is in this lane of those that were compared last.
    #[inline(always)]
    fn push(&mut self, pair: NodePair, lane: usize, order: Order<'_>) {
        if let Order::EarliestFirst(latest) = order {
            let bound = self.enter[lane % LANES];
            if f64::from(bound) <= latest.get() {
                if self.queue.len() < MOST_WAITING {
                    self.queue.push(Entry { bound, node: pair });
                } else {
                    self.stack.push(pair);
                }
            }
        } else if order == Order::Any
            && let (ChildKind::Leaf(a), ChildKind::Leaf(b)) = (pair.a.child.kind(), pair.b.child.kind())
        {
            self.leaves.push((a, b));
        } else {
            self.stack.push(pair);
        }
    }

    #[inline(always)]
    fn next(&mut self, order: Order<'_>) -> Option<NodePair> {
        if let Some(pair) = self.stack.pop() {
            return Some(pair);
        }
        if let Order::EarliestFirst(latest) = order {
            let next = self.queue.pop()?;
            self.bound = f64::from(next.bound);
            // All others are as late.
            return (self.bound <= latest.get()).then_some(next.node);
        }
        None
    }
}
