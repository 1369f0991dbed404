//! The one walk over two trees.

use std::ops::ControlFlow;

use super::cull::{CrossCull, Cull, Side, Walkable};
use crate::bounds::Volume;
use crate::pose::NodeRef;
use crate::tree::{ChildKind, Leaf};

/// Node pairs still to be looked at; reused between walks.
pub(crate) type Stack = Vec<(NodeRef, NodeRef)>;

/// A walk over the node pairs of two posed trees whose volumes may meet.
///
/// The children of the larger node are made, if they are not yet, and tested against the other node, eight at once (the
/// paper's Sect. 3: descend the larger).
pub(crate) struct PairWalk<'a, V: Volume, A, B> {
    pub(crate) a: &'a mut A,
    pub(crate) b: &'a mut B,
    /// The frames to compare volumes in.
    pub(crate) culls: &'a [Cull<V>],
    /// Further axes to compare boxes along, if wanted.
    pub(crate) cross: Option<&'a CrossCull>,
    /// Lengths in A's units per length in B's: to tell which of two nodes is larger.
    pub(crate) a_from_b_scale: f32,
    /// Volumes tested against volumes so far.
    pub(crate) node_tests: u64,
}

impl<V: Volume, A: Walkable<Kind = V>, B: Walkable<Kind = V>> PairWalk<'_, V, A, B> {
    /// Calls `at_leaves` for every pair of leaves whose volumes may meet, until it breaks.
    pub(crate) fn run(
        &mut self,
        stack: &mut Stack,
        mut at_leaves: impl FnMut(&mut A, &mut B, Leaf, Leaf) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        stack.clear();
        let (a, b) = (self.a.root(), self.b.root());
        self.node_tests += 1;
        let (root_a, root_b) = (self.a.volume(a), self.b.volume(b));
        if self.culls.iter().all(|cull| cull.overlap(&root_a, &root_b)) {
            stack.push((a, b));
        }
        while let Some((a, b)) = stack.pop() {
            match (a.child.kind(), b.child.kind()) {
                (ChildKind::Leaf(leaf_a), ChildKind::Leaf(leaf_b)) => at_leaves(self.a, self.b, leaf_a, leaf_b)?,
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
        let tests = Tests {
            side: Side::A,
            culls: self.culls,
            cross: self.cross,
        };
        let (slot, mask) = descend(self.a, group, &other, &tests, &mut self.node_tests);
        stack.extend(lanes_of(mask).map(|lane| (self.a.node(slot, group, lane), b)));
    }

    fn descend_b(&mut self, a: NodeRef, group: usize, stack: &mut Stack) {
        let other = self.a.volume(a);
        let tests = Tests {
            side: Side::B,
            culls: self.culls,
            cross: self.cross,
        };
        let (slot, mask) = descend(self.b, group, &other, &tests, &mut self.node_tests);
        stack.extend(lanes_of(mask).map(|lane| (a, self.b.node(slot, group, lane))));
    }
}

/// How the children of one side are tested against a volume of the other.
struct Tests<'a, V: Volume> {
    side: Side,
    culls: &'a [Cull<V>],
    cross: Option<&'a CrossCull>,
}

/// Opens a group and tests its children against the other body's volume: the group's slot and the lanes that may meet it.
#[inline]
fn descend<V: Volume, W: Walkable<Kind = V>>(
    tree: &mut W,
    group: usize,
    other: &V::One,
    tests: &Tests<'_, V>,
    node_tests: &mut u64,
) -> (usize, u8) {
    let slot = tree.open(group);
    let mask = tree.topology().group(group).mask();
    *node_tests += u64::from(mask.count_ones());
    let mut meeting = tree.overlap_mask(slot, tests.culls, tests.side, other, mask);
    if let Some(cross) = tests.cross
        && meeting != 0
    {
        meeting = cross.overlap_mask(tests.side, &tree.boxes(slot), &V::bounds(other), meeting);
    }
    (slot, meeting)
}

/// The set bits, last first, so that the first lane comes off the stack first.
fn lanes_of(mask: u8) -> impl Iterator<Item = usize> {
    (0..8).rev().filter(move |lane| mask >> lane & 1 == 1)
}
