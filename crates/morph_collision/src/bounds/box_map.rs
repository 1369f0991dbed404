use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::Vec3;

use super::lanes::{max, min};
use super::rounding::{U32, around};
use super::{Aabb, BoxLanes, Frame};

/// Roundings of a row of the map, each at most half a unit in the last place of the largest magnitude reached. At most ten
/// happen: the entries', three products and sums, the offset's, and those of the slack (docs/numerics.md).
const MAP_ROUNDINGS: f64 = 16.0;
/// Magnitudes beyond this could overflow in sums; such a map is not used.
const MAX_REACH: f64 = 1e37;
/// Covers what underflows in entries, and in products with them; far below any `f32` that is not subnormal.
const UNDERFLOW: f64 = 1e-42;

/// An affine map of boxes, conservative: each end of the image is an offset plus one scaled end of the source per axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoxMap {
    /// By axis of the source and of the image.
    columns: [[f32; 3]; 3],
    pub(super) offset_min: [f32; 3],
    pub(super) offset_max: [f32; 3],
}

impl BoxMap {
    /// The map to a frame for boxes within the frame's magnitude; `None` where `f32` cannot hold it.
    pub(crate) fn new(frame: &Frame) -> Option<Self> {
        let mut map = Self::default();
        map.set(frame).then_some(map)
    }

    /// Becomes the map to a frame; returns false where `f32` cannot hold it.
    #[inline]
    pub(crate) fn set(&mut self, frame: &Frame) -> bool {
        let (reach, offset) = (frame.reach(), frame.translation);
        let underflow = UNDERFLOW * (1.0 + frame.magnitude.element_sum());
        let slack = frame.error + MAP_ROUNDINGS * U32 * reach + underflow;
        let [x, y, z] = frame.linear.to_cols_array_2d();
        // The sum of everything, so that one comparison finds what is too large or NaN.
        let entries = [x, y, z]
            .as_flattened()
            .iter()
            .fold(0.0, |sum, entry| sum + entry.abs());
        let sum = (reach + slack).element_sum() + entries;
        let (low, high) = (offset - slack, offset + slack);
        for i in 0..3 {
            for (column, exact) in self.columns.iter_mut().zip([x, y, z]) {
                column[i] = exact[i] as f32;
            }
            (self.offset_min[i], self.offset_max[i]) = around(low[i], high[i]);
        }
        // False for NaN.
        sum <= MAX_REACH
    }

    /// The image of one box.
    #[inline]
    pub(crate) fn one(&self, one: &Aabb) -> Aabb {
        let (mut low, mut high) = (self.offset_min, self.offset_max);
        for (j, column) in self.columns.iter().enumerate() {
            for (i, factor) in column.iter().enumerate() {
                let (x, y) = (factor * one.min[j], factor * one.max[j]);
                low[i] += min(x, y);
                high[i] += max(x, y);
            }
        }
        Aabb {
            min: Vec3::from_array(low),
            max: Vec3::from_array(high),
        }
    }

    /// The images of eight boxes; lanes without a child get any values.
    #[inline(always)]
    pub(crate) fn all<S: Simd>(&self, simd: S, source: &BoxLanes, mapped: &mut BoxLanes) {
        let ([a, b, c], [d, e, f]) = (&source.min, &source.max);
        let low = [a.load(simd), b.load(simd), c.load(simd)];
        let high = [d.load(simd), e.load(simd), f.load(simd)];
        for i in 0..3 {
            let mut min = f32x8::splat(simd, self.offset_min[i]);
            let mut max = f32x8::splat(simd, self.offset_max[i]);
            for (j, column) in self.columns.iter().enumerate() {
                let factor = f32x8::splat(simd, column[i]);
                let (x, y) = (low[j] * factor, high[j] * factor);
                min += x.min(y);
                max += x.max(y);
            }
            min.store_slice(&mut mapped.min[i].0);
            max.store_slice(&mut mapped.max[i].0);
        }
    }
}
