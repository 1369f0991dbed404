//! The one walk over two trees.

use std::ops::ControlFlow;

use crate::bounds::{Aabb, Cull, Side};
use crate::pose::{NodeRef, Pose};
use crate::tree::{ChildKind, Leaf};

/// Node pairs still to be looked at; reused between walks.
pub(crate) type Stack = Vec<(NodeRef, NodeRef)>;

/// A walk over the node pairs of two posed trees whose boxes may meet.
///
/// The children of the larger node are blended, if they are not yet, and tested against the other node, eight at once
/// (the paper's Sect. 3: descend the larger, SAT-lite).
#[derive(Debug)]
pub(crate) struct PairWalk<'a> {
    pub(crate) a: &'a mut Pose,
    pub(crate) b: &'a mut Pose,
    /// The frames to compare boxes in, see [`culls_of`](crate::bounds::culls_of).
    pub(crate) culls: &'a [Cull],
    /// Lengths in A's units per length in B's: to tell which of two nodes is larger.
    pub(crate) a_from_b_scale: f32,
    /// Boxes tested against boxes so far.
    pub(crate) node_tests: u64,
}

impl PairWalk<'_> {
    /// Calls `at_leaves` for every pair of leaves whose boxes may meet, until it breaks.
    pub(crate) fn run(
        &mut self,
        stack: &mut Stack,
        mut at_leaves: impl FnMut(&mut Self, Leaf, Leaf) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        stack.clear();
        let (a, b) = (self.a.root(), self.b.root());
        self.node_tests += 1;
        let (box_a, box_b) = (self.a.node_bounds(a), self.b.node_bounds(b));
        if self.culls.iter().all(|cull| cull.overlaps(&box_a, &box_b)) {
            stack.push((a, b));
        }
        while let Some((a, b)) = stack.pop() {
            match (a.child.kind(), b.child.kind()) {
                (ChildKind::Leaf(a), ChildKind::Leaf(b)) => at_leaves(self, a, b)?,
                (ChildKind::Group(group), ChildKind::Leaf(_)) => self.descend_a(group, b, stack),
                (ChildKind::Leaf(_), ChildKind::Group(group)) => self.descend_b(a, group, stack),
                (ChildKind::Group(group_a), ChildKind::Group(group_b)) => {
                    let size_a = size(&self.a.node_bounds(a));
                    let size_b = size(&self.b.node_bounds(b)) * self.a_from_b_scale;
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
        let other = self.b.node_bounds(b);
        let (slot, mask) = descend(self.a, group, &other, self.culls, Side::A, &mut self.node_tests);
        stack.extend(lanes_of(mask).map(|lane| (self.a.node(slot, group, lane), b)));
    }

    fn descend_b(&mut self, a: NodeRef, group: usize, stack: &mut Stack) {
        let other = self.a.node_bounds(a);
        let (slot, mask) = descend(self.b, group, &other, self.culls, Side::B, &mut self.node_tests);
        stack.extend(lanes_of(mask).map(|lane| (a, self.b.node(slot, group, lane))));
    }
}

/// Opens a group and tests its children against the other body's box: the group's slot and the lanes that may meet it.
fn descend(
    pose: &mut Pose,
    group: usize,
    other: &Aabb,
    culls: &[Cull],
    side: Side,
    node_tests: &mut u64,
) -> (usize, u8) {
    let slot = pose.open(group);
    let children = pose.bvh().group(group).children().len();
    *node_tests += children as u64;
    let boxes = pose.boxes(slot);
    let mut mask = u8::MAX >> (8 - children);
    for cull in culls {
        if mask == 0 {
            break;
        }
        mask &= cull.overlap_mask(side, boxes, other);
    }
    (slot, mask)
}

/// The set bits, last first, so that the first lane comes off the stack first.
fn lanes_of(mask: u8) -> impl Iterator<Item = usize> {
    (0..8).rev().filter(move |lane| mask >> lane & 1 == 1)
}

fn size(bounds: &Aabb) -> f32 {
    bounds.size().element_sum()
}
