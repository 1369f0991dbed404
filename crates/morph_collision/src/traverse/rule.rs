use super::cull::Side;
use crate::bounds::{Aabb, LANES};
use crate::pose::{NodeRef, Posed};

/// Which node pairs a walk looks at, and in which order.
pub(crate) trait PairRule {
    /// What decides about a pair; lower ones come first among the children of a node.
    type Key: Copy + Default + PartialOrd;

    /// The key of two nodes to start from, usually the roots; `None` not to look at them.
    fn start(&self, a: &Aabb, b: &Aabb) -> Option<Self::Key>;

    /// The keys of an opened group's children against a node of the other side's tree, and the lanes to look at.
    fn children(
        &self,
        side: Side,
        own: (&Posed<'_>, Opened),
        other: (&Posed<'_>, NodeRef),
        keys: &mut [Self::Key; LANES],
    ) -> u8;

    /// Whether [`PairRule::both`] may be asked: keys need no order, and a step of the walk may be a large one.
    const TAKES_BOTH: bool = false;

    /// For each lane of `rows`, a mask of A's children, which ones of B's it is to be looked at with.
    #[inline]
    fn both(&self, _a: (&Posed<'_>, Opened), _b: (&Posed<'_>, Opened), _rows: u8) -> [u8; LANES] {
        [0; LANES]
    }

    /// How far each child in an opened group's slot reaches into a node of the other side's tree, about, by its slot and lane; both
    /// were looked at.
    #[inline]
    fn depths(&self, _side: Side, _own: (&Posed<'_>, usize), _other: (&Posed<'_>, usize, usize)) -> [f32; LANES] {
        [0.0; LANES]
    }

    /// Whether a pair that comes off the stack is still worth looking at.
    fn still_wanted(&self, key: Self::Key) -> bool;
}

/// A group whose boxes are made: where they are, and a bit per child.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opened {
    pub(crate) slot: usize,
    pub(crate) mask: u8,
}
