//! The walk over two trees.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use super::cull::Side;
use super::rule::{Opened, PairRule};
use crate::bounds::{LANES, lanes_of};
use crate::pose::{NodeId, NodeRef, Posed};
use crate::tree::{ChildKind, Leaf};

/// Nodes whose sizes differ by less than this factor are opened together. Chosen by instructions on the bench scenes (docs/tried.md).
const MAX_SIZE_RATIO: f32 = 3.0;

/// The node pairs still to visit, with the rule's keys. Walks reuse the memory.
pub(crate) type Stack<K = ()> = Vec<(K, NodeRef, NodeRef)>;

/// A depth-first walk over the node pairs of two posed trees that a rule selects.
///
/// Opens the larger node and tests its children against the other node, eight at once (the paper's Sect. 3: descend the larger).
/// Opens both nodes if they are of similar size and the rule allows it.
pub(crate) struct PairWalk<'a, 'p, R> {
    pub(crate) a: &'a mut Posed<'p>,
    pub(crate) b: &'a mut Posed<'p>,
    pub(crate) rule: &'a mut R,
    /// The length in A's units of a length of 1 in B's, to compare sizes.
    pub(crate) a_from_b_scale: f32,
    /// Whether to visit children that overlap deepest first. Pays if the walk ends at the first intersection.
    pub(crate) deepest_first: bool,
    /// Node bounds tested so far.
    pub(crate) node_tests: u64,
}

impl<R: PairRule> PairWalk<'_, '_, R> {
    /// Calls `at_leaves` for every pair of leaves that the rule selects until it breaks.
    ///
    /// Starts at the roots if `front` is empty, otherwise at its node pairs.
    pub(crate) fn run(
        &mut self,
        stack: &mut Stack<R::Key>,
        front: &[(NodeId, NodeId)],
        mut at_leaves: impl FnMut(&mut Self, Leaf, Leaf) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        stack.clear();
        let roots = [(NodeId { group: 0, lane: 0 }, NodeId { group: 0, lane: 0 })];
        for (a, b) in if front.is_empty() { &roots } else { front } {
            let (a, b) = (node_at(self.a, *a), node_at(self.b, *b));
            self.node_tests += 1;
            let tested = (front.is_empty() && R::ROOTS_ARE_TESTED).then(R::Key::default);
            let key = tested.or_else(|| self.rule.start(&self.a.node_box(a), &self.b.node_box(b)));
            stack.extend(key.map(|key| (key, a, b)));
            while let Some((key, a, b)) = stack.pop() {
                if !self.rule.still_wanted(key) {
                    continue;
                }
                match (a.child.kind(), b.child.kind()) {
                    (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => at_leaves(self, leaf_a, leaf_b)?,
                    _ => self.descend(a, b, stack),
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Expands the roots, level by level, into at least `least` node pairs if there are that many, in the order of the walk.
    pub(crate) fn front(&mut self, stack: &mut Stack<R::Key>, least: usize) -> Vec<(NodeId, NodeId)> {
        let mut front = vec![(self.a.root(), self.b.root())];
        let is_leaf = |node: &NodeRef| matches!(node.child.kind(), ChildKind::Leaf(_));
        let both_leaves = |(a, b): &(NodeRef, NodeRef)| is_leaf(a) && is_leaf(b);
        while front.len() < least && !front.iter().all(both_leaves) {
            let mut next = Vec::new();
            for pair in front {
                if both_leaves(&pair) {
                    next.push(pair);
                    continue;
                }
                stack.clear();
                self.descend(pair.0, pair.1, stack);
                next.extend(stack.drain(..).rev().map(|(_, a, b)| (a, b)));
            }
            front = next;
        }
        front.into_iter().map(|(a, b)| (a.id, b.id)).collect()
    }

    /// Pushes the selected pairs below two nodes, at least one of which is not a leaf.
    #[inline(always)]
    fn descend(&mut self, a: NodeRef, b: NodeRef, stack: &mut Stack<R::Key>) {
        match (a.child.kind(), b.child.kind()) {
            (ChildKind::Leaf(_), ChildKind::Leaf(_)) => {}
            (ChildKind::Group(group), ChildKind::Leaf(_)) => self.descend_one(Side::A, group, b, stack),
            (ChildKind::Leaf(_), ChildKind::Group(group)) => self.descend_one(Side::B, group, a, stack),
            (ChildKind::Group(group_a), ChildKind::Group(group_b)) => {
                let size_a = self.a.node_box(a).girth();
                let size_b = self.b.node_box(b).girth() * self.a_from_b_scale;
                let are_alike = size_a < MAX_SIZE_RATIO * size_b && size_b < MAX_SIZE_RATIO * size_a;
                if are_alike && R::OPENS_BOTH {
                    self.descend_both(group_a, (group_b, b), stack);
                } else if size_a >= size_b {
                    self.descend_one(Side::A, group_a, b, stack);
                } else {
                    self.descend_one(Side::B, group_b, a, stack);
                }
            }
        }
    }

    /// Pushes the children of one side's group, each with a node of the other side.
    #[inline(always)]
    fn descend_one(&mut self, side: Side, group: usize, other: NodeRef, stack: &mut Stack<R::Key>) {
        let (own_tree, other_tree) = match side {
            Side::A => (&mut *self.a, &*self.b),
            Side::B => (&mut *self.b, &*self.a),
        };
        let mut keys = [R::Key::default(); LANES];
        let opened = open(own_tree, group);
        self.node_tests += u64::from(opened.mask.count_ones());
        let (own, theirs) = (&*own_tree, (other_tree, other));
        let mask = self.rule.children(side, (own, opened), theirs, &mut keys);
        let first = stack.len();
        push(stack, mask, &keys, |lane| {
            let own = own.node(opened.slot, group, lane);
            match side {
                Side::A => (own, other),
                Side::B => (other, own),
            }
        });
        if self.deepest_first && mask & mask.wrapping_sub(1) != 0 {
            let depths = self.rule.depths(side, (own, opened.slot), theirs);
            sort_by_depth(&mut stack[first..], |(_, a, b)| {
                let own = if side == Side::A { a } else { b };
                depths[usize::from(own.id.lane) % LANES]
            });
        }
    }

    /// Pushes the pairs of children of two nodes. As many tests as opening one after the other, but one step of the walk.
    #[inline(always)]
    fn descend_both(&mut self, group_a: usize, (group_b, b): (usize, NodeRef), stack: &mut Stack<R::Key>) {
        let mut keys = [R::Key::default(); LANES];
        let mut opened_a = open(self.a, group_a);
        self.node_tests += u64::from(opened_a.mask.count_ones());
        let rows = self
            .rule
            .children(Side::A, (&*self.a, opened_a), (&*self.b, b), &mut keys);
        if rows == 0 {
            return;
        }
        opened_a.mask = rows;
        let opened_b = open(self.b, group_b);
        self.node_tests += u64::from(rows.count_ones()) * u64::from(opened_b.mask.count_ones());
        let (tree_a, tree_b) = (&*self.a, &*self.b);
        let masks = self.rule.both((tree_a, opened_a), (tree_b, opened_b));
        let node_a = |lane| tree_a.node(opened_a.slot, group_a, lane);
        let first = stack.len();
        for lane in lanes_reversed(rows) {
            let a = node_a(lane);
            push(stack, masks[lane], &keys, |lane| {
                (a, tree_b.node(opened_b.slot, group_b, lane))
            });
        }
        if self.deepest_first && stack.len() > first + 1 {
            let mut depths = [[0.0; LANES]; LANES];
            for lane in lanes_of(rows).filter(|&lane| masks[lane] != 0) {
                depths[lane] = self
                    .rule
                    .depths(Side::B, (tree_b, opened_b.slot), (tree_a, node_a(lane)));
            }
            sort_by_depth(&mut stack[first..], |(_, a, b)| {
                depths[usize::from(a.id.lane) % LANES][usize::from(b.id.lane) % LANES]
            });
        }
    }
}

fn node_at(tree: &mut Posed<'_>, place: NodeId) -> NodeRef {
    let slot = tree.open(place.group as usize);
    tree.node(slot, place.group as usize, usize::from(place.lane))
}

/// A group's boxes, blended if necessary.
#[inline(always)]
fn open(tree: &mut Posed<'_>, group: usize) -> Opened {
    Opened {
        slot: tree.open(group),
        mask: tree.topology.group(group).mask(),
    }
}

/// Pushes the lanes of a mask so that the lowest key is popped first, and among equals the first lane.
#[inline(always)]
fn push<K: Copy + PartialOrd>(
    stack: &mut Stack<K>,
    mask: u8,
    keys: &[K; LANES],
    pair: impl Fn(usize) -> (NodeRef, NodeRef),
) {
    stack.reserve(LANES);
    let first = stack.len();
    let mut left = mask;
    while left != 0 {
        let lane = left.ilog2() as usize;
        left &= !(1 << lane);
        let (a, b) = pair(lane);
        stack.push((keys[lane], a, b));
    }
    // Keys of size zero need no order.
    if size_of::<K>() > 0 {
        stack[first..].sort_by(|x, y| y.0.partial_cmp(&x.0).unwrap_or(Ordering::Equal));
    }
}

/// Sorts so that the deepest pair is popped first. Stable.
fn sort_by_depth<K: Copy>(pairs: &mut [(K, NodeRef, NodeRef)], depth: impl Fn(&(K, NodeRef, NodeRef)) -> f32) {
    // Insertion sort, for up to 64 pairs.
    for place in 1..pairs.len() {
        let (pair, deep) = (pairs[place], depth(&pairs[place]));
        let mut hole = place;
        while hole > 0 && depth(&pairs[hole - 1]) > deep {
            pairs[hole] = pairs[hole - 1];
            hole -= 1;
        }
        pairs[hole] = pair;
    }
}

/// The lanes of a mask in descending order, so that the first lane is popped first.
pub(super) fn lanes_reversed(mask: u8) -> impl Iterator<Item = usize> {
    (0..8).rev().filter(move |lane| mask >> lane & 1 == 1)
}
