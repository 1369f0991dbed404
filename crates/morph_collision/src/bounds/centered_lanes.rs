//! Eight boxes side by side, by their centres and half sizes.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::{Box64, BoxLanes, LANES};

/// Eight boxes by their centres and half sizes, to be mapped one at a time.
#[derive(Clone, Debug, Default)]
pub(crate) struct CenteredLanes {
    center: [[f64; LANES]; 3],
    half: [[f64; LANES]; 3],
}

impl CenteredLanes {
    /// Sets all eight boxes.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(&mut self, simd: S, boxes: &BoxLanes) {
        let by_two = f64x4::splat(simd, 0.5);
        for axis in 0..3 {
            let (min, high_min) = boxes.min[axis].load(simd).widen();
            let (max, high_max) = boxes.max[axis].load(simd).widen();
            let (center, high_center) = self.center[axis].split_at_mut(LANES / 2);
            ((min + max) * by_two).store_slice(center);
            ((high_min + high_max) * by_two).store_slice(high_center);
            let (half, high_half) = self.half[axis].split_at_mut(LANES / 2);
            ((max - min) * by_two).store_slice(half);
            ((high_max - high_min) * by_two).store_slice(high_half);
        }
    }

    pub(crate) fn get(&self, lane: usize) -> Box64 {
        let of = |[x, y, z]: &[[f64; LANES]; 3]| DVec3::new(x[lane], y[lane], z[lane]);
        Box64 {
            center: of(&self.center),
            half: of(&self.half),
        }
    }

    /// The middle of a widened box's image under a map with these columns, and how far the image reaches from it.
    #[inline(always)]
    pub(crate) fn image<S: Simd>(
        &self,
        simd: S,
        lane: usize,
        [x, y, z, offset]: [f64x4<S>; 4],
        widening: f64,
    ) -> [f64x4<S>; 2] {
        let lane = lane % LANES;
        let (mut middle, mut radius) = (offset, f64x4::splat(simd, 0.0));
        for ((column, center), half) in [x, y, z].into_iter().zip(&self.center).zip(&self.half) {
            middle += column * f64x4::splat(simd, center[lane]);
            radius += column.abs() * f64x4::splat(simd, half[lane] + widening);
        }
        [middle, radius]
    }
}
