//! The one walk over two trees.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use super::cull::{CrossCull, Cull, Side, Walkable};
use crate::bounds::{LANES, Volume};
use crate::pose::{NodeRef, Place};
use crate::tree::{ChildKind, Leaf};

/// Node pairs still to be looked at, with what the walk's rule says of them; reused between walks.
pub(crate) type Stack<K = ()> = Vec<(K, NodeRef, NodeRef)>;

/// Which node pairs a walk looks at, and in which order.
pub(crate) trait PairRule<V: Volume> {
    /// What decides about a pair; lower ones come first among the children of a node.
    type Key: Copy + Default + PartialOrd;

    /// The key of two nodes to start from, usually the roots; `None` not to look at them.
    fn start(&self, a: &V::One, b: &V::One) -> Option<Self::Key>;

    /// The keys of an opened group's children against the other side's volume, and the lanes to look at.
    fn children<W: Walkable<Kind = V>>(
        &self,
        tree: &W,
        opened: Opened,
        side: Side,
        other: &V::One,
        keys: &mut [Self::Key; LANES],
    ) -> u8;

    /// Whether a pair that comes off the stack is still worth looking at.
    fn still_wanted(&self, key: Self::Key) -> bool;

    /// Whether the walk may take the next pair off the stack; if not it ends there, and what it leaves stays on the stack.
    #[inline]
    fn goes_on(&self, _node_tests: u64) -> bool {
        true
    }

    /// Whether [`PairRule::settles`] is to be asked.
    const SETTLES: bool = false;

    /// Whether a pair that comes off the stack is answered as it is, so that nothing below it is looked at.
    #[inline]
    fn settles(&self, _a: (NodeRef, &V::One), _b: (NodeRef, &V::One)) -> bool {
        false
    }

    /// A lower bound of the distance in A's space between two volumes that the rule does not want.
    fn gap(&self, _a: &V::One, _b: &V::One) -> f64 {
        0.0
    }
}

/// What a walk leaves behind for the next frame.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    /// The node pairs at which the walk ended: not wanted, or leaves. Whatever they become, all leaf pairs are below them.
    pub(crate) front: Vec<(Place, Place)>,
    /// A lower bound of the distance in A's space between the bodies' parts that were not wanted; 0 if leaves were.
    pub(crate) gap: f64,
}

/// A group whose volumes are made: where they are, and a bit per child.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opened {
    pub(crate) group: usize,
    pub(crate) slot: usize,
    pub(crate) mask: u8,
}

/// The rule of node pairs whose volumes may meet in every one of some frames.
#[derive(Debug)]
pub(crate) struct Meeting<'a, V: Volume> {
    pub(crate) culls: &'a [Cull<V>],
    /// Further axes to compare boxes along, if wanted.
    pub(crate) cross: Option<&'a CrossCull>,
}

impl<V: Volume> PairRule<V> for Meeting<'_, V> {
    type Key = ();

    fn start(&self, a: &V::One, b: &V::One) -> Option<()> {
        self.culls.iter().all(|cull| cull.overlap(a, b)).then_some(())
    }

    #[inline]
    fn children<W: Walkable<Kind = V>>(
        &self,
        tree: &W,
        opened: Opened,
        side: Side,
        other: &V::One,
        _keys: &mut [(); LANES],
    ) -> u8 {
        let mask = tree.overlap_mask(opened.slot, self.culls, side, other, opened.mask);
        match self.cross {
            Some(cross) if mask != 0 => {
                cross.overlap_mask(tree.level(), side, &tree.boxes(opened.slot), &V::bounds(other), mask)
            }
            _ => mask,
        }
    }

    #[inline]
    fn still_wanted(&self, (): ()) -> bool {
        true
    }

    fn gap(&self, a: &V::One, b: &V::One) -> f64 {
        self.culls.iter().map(|cull| cull.gap(a, b)).fold(0.0, f64::max)
    }
}

/// A walk over the node pairs of two posed trees that a rule wants looked at, depth first.
///
/// The children of the larger node are made, if they are not yet, and tested against the other node, eight at once (the
/// paper's Sect. 3: descend the larger).
pub(crate) struct PairWalk<'a, R, A, B> {
    pub(crate) a: &'a mut A,
    pub(crate) b: &'a mut B,
    pub(crate) rule: &'a R,
    /// Lengths in A's units per length in B's: to tell which of two nodes is larger.
    pub(crate) a_from_b_scale: f32,
    /// Volumes tested against volumes so far.
    pub(crate) node_tests: u64,
    /// Filled if it is there.
    pub(crate) trace: Option<&'a mut Trace>,
}

impl<V: Volume, R: PairRule<V>, A: Walkable<Kind = V>, B: Walkable<Kind = V>> PairWalk<'_, R, A, B> {
    /// Calls `at_leaves` for every pair of leaves that the rule wants, until it breaks.
    ///
    /// Starts from the roots, or from the front of an earlier walk over the same trees.
    pub(crate) fn run(
        &mut self,
        stack: &mut Stack<R::Key>,
        front: &[(Place, Place)],
        mut at_leaves: impl FnMut(&mut A, &mut B, Leaf, Leaf) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        stack.clear();
        let root = Place { group: 0, lane: 0 };
        let start = if front.is_empty() { &[(root, root)] } else { front };
        for (done, (a, b)) in start.iter().enumerate() {
            let (a, b) = (node_at(self.a, *a), node_at(self.b, *b));
            self.node_tests += 1;
            match self.rule.start(&self.a.volume(a), &self.b.volume(b)) {
                Some(key) => stack.push((key, a, b)),
                None => self.note_unwanted(a, b),
            }
            if self.drain(stack, &mut at_leaves).is_break() {
                if let Some(trace) = &mut self.trace {
                    trace.front.extend(stack.iter().map(|(_, a, b)| (a.place, b.place)));
                    trace.front.extend(&start[done + 1..]);
                }
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }

    fn drain(
        &mut self,
        stack: &mut Stack<R::Key>,
        at_leaves: &mut impl FnMut(&mut A, &mut B, Leaf, Leaf) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        while !stack.is_empty() && self.rule.goes_on(self.node_tests) {
            let Some((key, a, b)) = stack.pop() else { break };
            if !self.rule.still_wanted(key) {
                self.note_unwanted(a, b);
                continue;
            }
            if R::SETTLES && self.rule.settles((a, &self.a.volume(a)), (b, &self.b.volume(b))) {
                continue;
            }
            match (a.child.kind(), b.child.kind()) {
                (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => {
                    if let Some(trace) = &mut self.trace {
                        trace.front.push((a.place, b.place));
                        trace.gap = 0.0;
                    }
                    at_leaves(self.a, self.b, leaf_a, leaf_b)?;
                }
                (ChildKind::Group(group), ChildKind::Leaf(_)) => self.descend_a(group, b, stack),
                (ChildKind::Leaf(_), ChildKind::Group(group)) => self.descend_b(a, group, stack),
                (ChildKind::Group(group_a), ChildKind::Group(group_b)) => {
                    let size_a = V::size(&self.a.volume(a));
                    let size_b = V::size(&self.b.volume(b)) * self.a_from_b_scale;
                    if size_a >= size_b {
                        self.descend_a(group_a, b, stack);
                    } else {
                        self.descend_b(a, group_b, stack);
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn descend_a(&mut self, group: usize, b: NodeRef, stack: &mut Stack<R::Key>) {
        let (other, mut keys) = (self.b.volume(b), [R::Key::default(); LANES]);
        let opened = open(self.a, group, &mut self.node_tests);
        let mask = self.rule.children(self.a, opened, Side::A, &other, &mut keys);
        push(stack, mask, &keys, |lane| (self.a.node(opened.slot, group, lane), b));
        if self.trace.is_some() {
            lanes_of(opened.mask & !mask).for_each(|lane| self.note_unwanted(self.a.node(opened.slot, group, lane), b));
        }
    }

    fn descend_b(&mut self, a: NodeRef, group: usize, stack: &mut Stack<R::Key>) {
        let (other, mut keys) = (self.a.volume(a), [R::Key::default(); LANES]);
        let opened = open(self.b, group, &mut self.node_tests);
        let mask = self.rule.children(self.b, opened, Side::B, &other, &mut keys);
        push(stack, mask, &keys, |lane| (a, self.b.node(opened.slot, group, lane)));
        if self.trace.is_some() {
            lanes_of(opened.mask & !mask).for_each(|lane| self.note_unwanted(a, self.b.node(opened.slot, group, lane)));
        }
    }

    /// The walk ends at two nodes that are no pair of leaves.
    fn note_unwanted(&mut self, a: NodeRef, b: NodeRef) {
        let Some(trace) = &mut self.trace else { return };
        trace.front.push((a.place, b.place));
        if trace.gap > 0.0 {
            trace.gap = trace.gap.min(self.rule.gap(&self.a.volume(a), &self.b.volume(b)));
        }
    }
}

fn node_at(tree: &mut impl Walkable, place: Place) -> NodeRef {
    let slot = tree.open(place.group as usize);
    tree.node(slot, place.group as usize, usize::from(place.lane))
}

/// Makes a group's volumes unless they are there.
#[inline]
fn open(tree: &mut impl Walkable, group: usize, node_tests: &mut u64) -> Opened {
    let slot = tree.open(group);
    let mask = tree.topology().group(group).mask();
    *node_tests += u64::from(mask.count_ones());
    Opened { group, slot, mask }
}

/// Pushes the lanes of a mask so that the lowest key comes off the stack first, among equals the first lane.
#[inline]
fn push<K: Copy + PartialOrd>(
    stack: &mut Stack<K>,
    mask: u8,
    keys: &[K; LANES],
    pair: impl Fn(usize) -> (NodeRef, NodeRef),
) {
    let first = stack.len();
    let mut left = mask;
    while left != 0 {
        let lane = left.ilog2() as usize;
        left &= !(1 << lane);
        let (a, b) = pair(lane);
        stack.push((keys[lane], a, b));
    }
    // Keys without content need no order.
    if size_of::<K>() > 0 {
        stack[first..].sort_by(|x, y| y.0.partial_cmp(&x.0).unwrap_or(Ordering::Equal));
    }
}

/// The set bits, last first, so that the first lane comes off the stack first.
pub(super) fn lanes_of(mask: u8) -> impl Iterator<Item = usize> {
    (0..8).rev().filter(move |lane| mask >> lane & 1 == 1)
}
