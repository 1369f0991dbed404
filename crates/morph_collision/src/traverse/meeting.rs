//! The rule by which pair queries walk.

use std::cell::RefCell;

use super::cull::{CrossCull, Culls, Side};
use super::pairs::{Opened, PairRule, lanes_of};
use super::walkable::Walkable;
use crate::bounds::{LANES, Volume, with_simd};
use crate::pose::NodeRef;

/// The rule of node pairs whose volumes may meet in every one of some frames.
#[derive(Debug)]
pub(crate) struct Meeting<'a, V: Volume> {
    pub(crate) culls: RefCell<&'a mut Culls<V>>,
    /// Further axes to compare boxes along, if wanted.
    pub(crate) cross: Option<&'a CrossCull>,
}

impl<V: Volume> PairRule<V> for Meeting<'_, V> {
    type Key = ();

    fn start(&self, a: &V::One, b: &V::One) -> Option<()> {
        self.culls.borrow().overlap(a, b).then_some(())
    }

    #[inline(always)]
    fn children<T: Walkable<Kind = V>>(
        &self,
        side: Side,
        (tree, opened): (&T, Opened),
        (other, node): (&T, NodeRef),
        _keys: &mut [(); LANES],
    ) -> u8 {
        let mut culls = self.culls.borrow_mut();
        let own = (tree, opened.slot, opened.mask);
        let mask = with_simd!(tree.level(), simd => culls.overlap_mask(simd, side, own, (other, node)));
        match self.cross {
            Some(cross) if mask != 0 => {
                let bounds = V::bounds(&other.volume(node));
                cross.overlap_mask(tree.level(), side, &tree.boxes(opened.slot), &bounds, mask)
            }
            _ => mask,
        }
    }

    #[inline(always)]
    fn takes_both(&self) -> bool {
        true
    }

    #[inline(always)]
    fn both<T: Walkable<Kind = V>>(
        &self,
        (tree_a, a): (&T, Opened),
        (tree_b, b): (&T, Opened),
        rows: u8,
    ) -> [u8; LANES] {
        let mut culls = self.culls.borrow_mut();
        let mut masks = [0; LANES];
        with_simd!(tree_a.level(), simd => culls.overlap_rows(simd, (tree_a, a.slot, rows), (tree_b, b.slot, b.mask), &mut masks));
        if let Some(cross) = self.cross {
            let boxes = tree_b.boxes(b.slot);
            for lane in lanes_of(rows) {
                let bounds = V::bounds(&tree_a.volume(tree_a.node(a.slot, a.group, lane)));
                masks[lane] = cross.overlap_mask(tree_a.level(), Side::B, &boxes, &bounds, masks[lane]);
            }
        }
        masks
    }

    #[inline(always)]
    fn depths<T: Walkable<Kind = V>>(
        &self,
        side: Side,
        (tree, slot): (&T, usize),
        (other, other_slot, lane): (&T, usize, usize),
    ) -> [f32; LANES] {
        let culls = self.culls.borrow();
        let mut depths = [0.0; LANES];
        let own = (tree, slot);
        let other = (other, other_slot, lane);
        with_simd!(tree.level(), simd => culls.depths(simd, side, own, other, &mut depths));
        depths
    }

    #[inline]
    fn still_wanted(&self, (): ()) -> bool {
        true
    }

    fn gap(&self, a: &V::One, b: &V::One) -> f64 {
        self.culls.borrow().gap(a, b)
    }
}
