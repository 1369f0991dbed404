use super::cull::Side;
use crate::bounds::{Aabb, LANES};
use crate::pose::{NodeRef, Posed};

/// Selects the node pairs that a walk visits, and their order.
pub(crate) trait PairRule {
    /// The sort key of a pair. Among the children of a node, lower keys come first.
    type Key: Copy + Default + PartialOrd;

    /// Whether the caller tests the roots before the walk. They then have the default key.
    const ROOTS_ARE_TESTED: bool = false;

    /// The key of two nodes to start at; `None` to skip them.
    fn start(&mut self, a: &Aabb, b: &Aabb) -> Option<Self::Key>;

    /// Writes the keys of an opened group's children against a node of the other tree; returns the selected lanes.
    fn children(
        &mut self,
        side: Side,
        own: (&Posed<'_>, Opened),
        other: (&Posed<'_>, NodeRef),
        keys: &mut [Self::Key; LANES],
    ) -> u8;

    /// Whether the walk may call [`PairRule::both`]. Keys then have no order.
    const OPENS_BOTH: bool = false;

    /// For each lane in A's mask, the selected children of B.
    #[inline]
    fn both(&mut self, _a: (&Posed<'_>, Opened), _b: (&Posed<'_>, Opened)) -> [u8; LANES] {
        [0; LANES]
    }

    /// Roughly how deep each child in an opened slot overlaps a node of the other tree. Both were tested before.
    #[inline]
    fn depths(&mut self, _side: Side, _own: (&Posed<'_>, usize), _other: (&Posed<'_>, NodeRef)) -> [f32; LANES] {
        [0.0; LANES]
    }

    /// Whether to visit a pair that was popped.
    #[inline]
    fn still_wanted(&self, _key: Self::Key) -> bool {
        true
    }
}

/// A group with blended boxes: their slot, and a bit per child.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opened {
    pub(crate) slot: usize,
    pub(crate) mask: u8,
}
