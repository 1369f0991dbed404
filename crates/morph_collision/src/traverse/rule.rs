use super::cull::Side;
use crate::bounds::{Aabb, LANES};
use crate::pose::{NodeRef, Posed};

/// Selects the node pairs that a walk visits, and their order.
pub(crate) trait PairRule {
    /// The sort key of a pair. Among the children of a node, lower keys come first.
    type Key: Copy + Default + PartialOrd;

    /// The key of two nodes to start at; `None` to skip them.
    fn start(&self, a: &Aabb, b: &Aabb) -> Option<Self::Key>;

    /// Writes the keys of an opened group's children against a node of the other tree; returns the selected lanes.
    fn children(
        &self,
        side: Side,
        own: (&Posed<'_>, Opened),
        other: (&Posed<'_>, NodeRef),
        keys: &mut [Self::Key; LANES],
    ) -> u8;

    /// Whether the walk may call [`PairRule::both`]. Keys then have no order.
    const OPENS_BOTH: bool = false;

    /// For each lane of `rows`, a mask of A's children, the selected children of B.
    #[inline]
    fn both(&self, _a: (&Posed<'_>, Opened), _b: (&Posed<'_>, Opened), _rows: u8) -> [u8; LANES] {
        [0; LANES]
    }

    /// Roughly how deep each child in an opened slot overlaps a node of the other tree, given by its slot and lane. Both were tested
    /// before.
    #[inline]
    fn depths(&self, _side: Side, _own: (&Posed<'_>, usize), _other: (&Posed<'_>, usize, usize)) -> [f32; LANES] {
        [0.0; LANES]
    }

    /// Whether to visit a pair that was popped.
    fn still_wanted(&self, key: Self::Key) -> bool;
}

/// A group with blended boxes: their slot, and a bit per child.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opened {
    pub(crate) slot: usize,
    pub(crate) mask: u8,
}
