//! Eight numbers side by side, and bit masks over them.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

/// The maximum number of children of a node, and the width of every kernel.
pub(crate) const LANES: usize = 8;

/// One coordinate of each of eight boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Lanes(pub(crate) [f32; LANES]);

impl Lanes {
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x8::from_slice(simd, &self.0)
    }

    /// `self += a * x` in each lane; multiplies, then adds.
    #[inline(always)]
    pub(crate) fn add_scaled<S: Simd>(&mut self, simd: S, a: f32, x: &Self) {
        (self.load(simd) + x.load(simd) * f32x8::splat(simd, a)).store_slice(&mut self.0);
    }

    #[inline(always)]
    pub(crate) fn add<S: Simd>(&mut self, simd: S, value: f32) {
        (self.load(simd) + f32x8::splat(simd, value)).store_slice(&mut self.0);
    }
}

/// The lanes whose bits are set in a mask, ascending.
#[inline(always)]
pub(crate) fn lanes_of(mask: u8) -> impl Iterator<Item = usize> {
    // Wider than the mask, which takes fewer instructions.
    let mut left = u32::from(mask);
    std::iter::from_fn(move || {
        let lane = left.trailing_zeros() as usize;
        left &= left.checked_sub(1)?;
        Some(lane)
    })
}
