//! The one walk over two trees.

use std::ops::ControlFlow;

use super::cull::{Cull, Side, Walkable};
use crate::bounds::Volume;
use crate::pose::{NodeRef, Place};
use crate::tree::{ChildKind, Leaf};

/// Node pairs still to be looked at; reused between walks.
pub(crate) type Stack = Vec<(NodeRef, NodeRef)>;

/// What a walk leaves behind for the next frame.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    /// The node pairs at which the walk ended: apart, or leaves. Whatever they become, all leaf pairs are below them.
    pub(crate) front: Vec<(Place, Place)>,
    /// A lower bound of the distance in A's space between the bodies' parts that were found apart.
    pub(crate) gap: f64,
}

/// A walk over the node pairs of two posed trees whose volumes may meet.
///
/// The children of the larger node are made, if they are not yet, and tested against the other node, eight at once (the
/// paper's Sect. 3: descend the larger).
pub(crate) struct PairWalk<'a, V: Volume, A, B> {
    pub(crate) a: &'a mut A,
    pub(crate) b: &'a mut B,
    /// The frames to compare volumes in.
    pub(crate) culls: &'a [Cull<V>],
    /// Lengths in A's units per length in B's: to tell which of two nodes is larger.
    pub(crate) a_from_b_scale: f32,
    /// Volumes tested against volumes so far.
    pub(crate) node_tests: u64,
    /// Filled if it is there.
    pub(crate) trace: Option<&'a mut Trace>,
}

impl<V: Volume, A: Walkable<Kind = V>, B: Walkable<Kind = V>> PairWalk<'_, V, A, B> {
    /// Calls `at_leaves` for every pair of leaves whose volumes may meet, until it breaks.
    ///
    /// Starts from the roots, or from the front of an earlier walk over the same trees.
    pub(crate) fn run(
        &mut self,
        stack: &mut Stack,
        front: &[(Place, Place)],
        mut at_leaves: impl FnMut(&mut A, &mut B, Leaf, Leaf) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        stack.clear();
        let root = Place { group: 0, lane: 0 };
        let start = if front.is_empty() { &[(root, root)] } else { front };
        for (done, (a, b)) in start.iter().enumerate() {
            let (a, b) = (node_at(self.a, *a), node_at(self.b, *b));
            self.node_tests += 1;
            let (volume_a, volume_b) = (self.a.volume(a), self.b.volume(b));
            if self.culls.iter().all(|cull| cull.overlap(&volume_a, &volume_b)) {
                stack.push((a, b));
            } else {
                self.note_apart(a, b);
            }
            if self.drain(stack, &mut at_leaves).is_break() {
                if let Some(trace) = &mut self.trace {
                    trace.front.extend(stack.iter().map(|(a, b)| (a.place, b.place)));
                    trace.front.extend(&start[done + 1..]);
                }
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }

    fn drain(
        &mut self,
        stack: &mut Stack,
        at_leaves: &mut impl FnMut(&mut A, &mut B, Leaf, Leaf) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        while let Some((a, b)) = stack.pop() {
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

    fn descend_a(&mut self, group: usize, b: NodeRef, stack: &mut Stack) {
        let other = self.b.volume(b);
        let (slot, mask, apart) = descend(self.a, group, &other, self.culls, Side::A, &mut self.node_tests);
        stack.extend(lanes_of(mask).map(|lane| (self.a.node(slot, group, lane), b)));
        if self.trace.is_some() {
            lanes_of(apart).for_each(|lane| self.note_apart(self.a.node(slot, group, lane), b));
        }
    }

    fn descend_b(&mut self, a: NodeRef, group: usize, stack: &mut Stack) {
        let other = self.a.volume(a);
        let (slot, mask, apart) = descend(self.b, group, &other, self.culls, Side::B, &mut self.node_tests);
        stack.extend(lanes_of(mask).map(|lane| (a, self.b.node(slot, group, lane))));
        if self.trace.is_some() {
            lanes_of(apart).for_each(|lane| self.note_apart(a, self.b.node(slot, group, lane)));
        }
    }

    /// Two nodes were found apart.
    fn note_apart(&mut self, a: NodeRef, b: NodeRef) {
        let Some(trace) = &mut self.trace else { return };
        trace.front.push((a.place, b.place));
        if trace.gap > 0.0 {
            let (volume_a, volume_b) = (self.a.volume(a), self.b.volume(b));
            let gaps = self.culls.iter().map(|cull| cull.gap(&volume_a, &volume_b));
            trace.gap = trace.gap.min(gaps.fold(0.0, f64::max));
        }
    }
}

fn node_at(tree: &mut impl Walkable, place: Place) -> NodeRef {
    let slot = tree.open(place.group as usize);
    tree.node(slot, place.group as usize, usize::from(place.lane))
}

/// Opens a group and tests its children against the other body's volume: the group's slot, the lanes that may meet it, and
/// those that are apart from it.
#[inline]
fn descend<V: Volume, W: Walkable<Kind = V>>(
    tree: &mut W,
    group: usize,
    other: &V::One,
    culls: &[Cull<V>],
    side: Side,
    node_tests: &mut u64,
) -> (usize, u8, u8) {
    let slot = tree.open(group);
    let children = tree.topology().group(group).mask();
    *node_tests += u64::from(children.count_ones());
    let mask = tree.overlap_mask(slot, culls, side, other, children);
    (slot, mask, children & !mask)
}

/// The set bits, last first, so that the first lane comes off the stack first.
pub(super) fn lanes_of(mask: u8) -> impl Iterator<Item = usize> {
    (0..8).rev().filter(move |lane| mask >> lane & 1 == 1)
}
