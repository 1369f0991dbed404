//! How far targets move the ends of boxes towards their reference boxes.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

use super::{Aabb, BoxLanes, LANES, Lanes};

/// How the boxes of a node's `W` children move per unit of a weight: six rows of `W` numbers, lower ends first.
///
/// Rows are stored without gaps and read eight lanes wide. Lanes without a child get meaningless numbers; callers mask them out.
#[derive(Clone, Copy)]
pub(crate) struct Slopes<'a, const W: usize> {
    min: &'a [f32],
    max: &'a [f32],
}

/// How many numbers the slopes of `width` children take.
pub(crate) const fn slopes_len(width: usize) -> usize {
    6 * width
}

impl<'a, const W: usize> Slopes<'a, W> {
    /// The slopes at an index of a list. The list must end with [`LANES`] unused numbers.
    #[inline(always)]
    pub(crate) fn at(list: &'a [f32], index: usize) -> Self {
        let slopes = &list[index * slopes_len(W)..][..5 * W + LANES];
        Self {
            min: &slopes[..2 * W + LANES],
            max: &slopes[3 * W..],
        }
    }
}

/// Appends the slopes of a node's children to a list.
pub(crate) fn push_slopes(list: &mut Vec<f32>, slopes: &[Aabb]) {
    for end in [|slope: &Aabb| slope.min, |slope: &Aabb| slope.max] {
        for axis in 0..3 {
            list.extend(slopes.iter().map(|slope| end(slope)[axis]));
        }
    }
}

impl BoxLanes {
    /// `self += a * slopes` for `a >= 0`.
    #[inline(always)]
    pub(crate) fn add_scaled<S: Simd, const W: usize>(&mut self, simd: S, a: f32, slopes: Slopes<'_, W>) {
        let a = f32x8::splat(simd, a);
        for axis in 0..3 {
            let row = |end: &[f32]| f32x8::from_slice(simd, &end[axis * W..][..LANES]);
            add_row(simd, &mut self.min[axis], a, row(slopes.min));
            add_row(simd, &mut self.max[axis], a, row(slopes.max));
        }
    }
}

/// `row += a * slopes`; multiplies, then adds.
#[inline(always)]
pub(super) fn add_row<S: Simd>(simd: S, row: &mut Lanes, a: f32x8<S>, slopes: f32x8<S>) {
    (row.load(simd) + slopes * a).store_slice(&mut row.0);
}
