//! What walks over pairs of nodes need of a tree: its nodes, and their boxes.

use fearless_simd::Level;

use super::posed::{NodeRef, Posed};
use crate::bounds::{Aabb, BoxLanes, MovingLanes};
use crate::tree::{NodeId, Topology};

/// A tree with a box for every node: those of a pose, or those of a body that moves from one pose to another.
pub(crate) trait BoxTree {
    /// Whether the boxes move. Then [`BoxTree::boxes`] contain the whole motion.
    const MOVES: bool = false;

    fn topology(&self) -> &Topology;

    /// The SIMD level of the kernels.
    fn level(&self) -> Level;

    /// Returns the slot of a group's boxes; computes them unless they are cached.
    fn open(&mut self, group: usize) -> usize;

    /// The boxes in a slot of the cache.
    fn boxes(&self, slot: usize) -> &BoxLanes;

    /// The boxes in a slot of the cache at the start and at the end of the motion, if they move.
    fn moving_boxes(&self, _slot: usize) -> Option<&MovingLanes> {
        None
    }

    #[inline(always)]
    fn node(&self, slot: usize, group: usize, lane: usize) -> NodeRef {
        NodeRef {
            child: self.topology().group(group).child(lane),
            slot: slot as u32,
            id: NodeId::new(group, lane),
        }
    }

    /// A node's box, in the body's space.
    #[inline]
    fn node_box(&self, node: NodeRef) -> Aabb {
        self.boxes(node.slot as usize).get(usize::from(node.id.lane))
    }
}

impl BoxTree for Posed<'_> {
    #[inline(always)]
    fn topology(&self) -> &Topology {
        self.topology
    }

    #[inline(always)]
    fn level(&self) -> Level {
        self.level
    }

    #[inline(always)]
    fn open(&mut self, group: usize) -> usize {
        self.open(group)
    }

    #[inline(always)]
    fn boxes(&self, slot: usize) -> &BoxLanes {
        self.boxes(slot)
    }
}
