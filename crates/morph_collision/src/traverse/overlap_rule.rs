//! The rule of pair queries.

use std::cell::RefCell;

use super::cull::{Culls, Side};
use super::rule::{Opened, PairRule};
use crate::bounds::{Aabb, LANES, with_simd};
use crate::pose::{NodeRef, Posed};

/// Selects node pairs whose boxes overlap in every frame.
#[derive(Debug)]
pub(crate) struct OverlapRule<'a> {
    pub(crate) culls: RefCell<&'a mut Culls>,
}

impl PairRule for OverlapRule<'_> {
    type Key = ();

    const OPENS_BOTH: bool = true;

    fn start(&self, a: &Aabb, b: &Aabb) -> Option<()> {
        self.culls.borrow().overlap(a, b).then_some(())
    }

    #[inline(always)]
    fn children(
        &self,
        side: Side,
        (tree, opened): (&Posed<'_>, Opened),
        (other, node): (&Posed<'_>, NodeRef),
        _keys: &mut [(); LANES],
    ) -> u8 {
        let mut culls = self.culls.borrow_mut();
        let own = (tree, opened.slot, opened.mask);
        with_simd!(tree.level, simd => culls.overlap_mask(simd, side, own, (other, node)))
    }

    #[inline(always)]
    fn both(&self, (tree_a, a): (&Posed<'_>, Opened), (tree_b, b): (&Posed<'_>, Opened), rows: u8) -> [u8; LANES] {
        let mut culls = self.culls.borrow_mut();
        let mut masks = [0; LANES];
        with_simd!(tree_a.level, simd => culls.overlap_rows(simd, (tree_a, a.slot, rows), (tree_b, b.slot, b.mask), &mut masks));
        masks
    }

    #[inline(always)]
    fn depths(
        &self,
        side: Side,
        (tree, slot): (&Posed<'_>, usize),
        (other, other_slot, lane): (&Posed<'_>, usize, usize),
    ) -> [f32; LANES] {
        let culls = self.culls.borrow();
        let mut depths = [0.0; LANES];
        let own = (tree, slot);
        let other = (other, other_slot, lane);
        with_simd!(tree.level, simd => culls.depths(simd, side, own, other, &mut depths));
        depths
    }

    #[inline]
    fn still_wanted(&self, (): ()) -> bool {
        true
    }
}
