//! Nodes of both bodies, as the walk stores them.

use crate::bounds::LANES;
use crate::tree::Child;

/// Where the box of a node is: a slot of a body's [`MappedBoxes`](super::mapped_boxes::MappedBoxes), and a lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxAt {
    pub(super) slot: usize,
    pub(super) lane: usize,
}

/// A node of one body: its child entry, and the location of its box in the body's [`MappedBoxes`](super::mapped_boxes::MappedBoxes).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub(super) child: Child,
    /// `LANES` times the slot of its siblings, plus its lane.
    at: u32,
}

impl Node {
    /// The child in a lane of a slot.
    #[inline(always)]
    pub(super) fn new(child: Child, slot: usize, lane: usize) -> Self {
        Self {
            child,
            at: (slot * LANES + lane) as u32,
        }
    }

    #[inline(always)]
    pub(super) fn slot(self) -> usize {
        self.at as usize / LANES
    }

    #[inline(always)]
    pub(super) fn lane(self) -> usize {
        self.at as usize % LANES
    }

    #[inline(always)]
    pub(super) fn box_at(self) -> BoxAt {
        BoxAt {
            slot: self.slot(),
            lane: self.lane(),
        }
    }
}

/// A pair of nodes, one of each body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NodePair {
    pub(super) a: Node,
    pub(super) b: Node,
}

impl NodePair {
    #[inline(always)]
    pub(super) fn are_leaves(self) -> bool {
        self.a.child.is_leaf() && self.b.child.is_leaf()
    }
}
