use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::Vec3;

use super::lanes::{max, min};
use super::rounding::{U32, around};
use super::{Aabb, BoxLanes, Frame, Lanes};

/// Roundings of a row of the map, each at most half a unit in the last place of the largest magnitude reached. At most ten
/// happen: the entries', three products and sums, the offset's, and those of the slack (docs/numerics.md).
const MAP_ROUNDINGS: f64 = 16.0;
/// Magnitudes beyond this could overflow in sums; such a map is not used.
const MAX_REACH: f64 = 1e37;
/// Covers what underflows in entries, and in products with them; far below any `f32` that is not subnormal.
const UNDERFLOW: f64 = 1e-42;

/// An affine map of boxes, conservative: each end of the image is an offset plus one scaled end of the source per axis.
#[derive(Clone, Debug)]
pub(crate) struct BoxMap {
    /// By axis of the image and of the source.
    terms: [[Term; 3]; 3],
    pub(super) offset_min: [f32; 3],
    pub(super) offset_max: [f32; 3],
}

/// What an axis of the source adds to both ends along an axis of the image.
#[derive(Clone, Copy, Debug, Default)]
struct Term {
    /// The rows of the source that go to the lower and to the upper end: 0 to 2 for its lower ends, 3 to 5 for its upper ones.
    low: u8,
    high: u8,
    factor: f32,
}

impl BoxMap {
    /// The map to a frame for boxes within the frame's magnitude; `None` where `f32` cannot hold it.
    pub(crate) fn new(frame: &Frame) -> Option<Self> {
        let mut map = Self {
            terms: [[Term::default(); 3]; 3],
            offset_min: [0.0; 3],
            offset_max: [0.0; 3],
        };
        let rows = frame.linear.transpose();
        let underflow = UNDERFLOW * (1.0 + frame.magnitude.element_sum());
        // The sum of everything, so that one comparison finds what is too large or NaN.
        let mut sum = 0.0;
        for i in 0..3 {
            let (row, offset) = (rows.col(i), frame.translation[i]);
            let reach = row.abs().dot(frame.magnitude) + offset.abs();
            let slack = frame.error[i] + MAP_ROUNDINGS * U32 * reach + underflow;
            sum += reach + slack + row.x.abs() + row.y.abs() + row.z.abs();
            for (j, term) in map.terms[i].iter_mut().enumerate() {
                // A negative factor takes the upper end to the lower one.
                let negative = usize::from(row[j] < 0.0);
                *term = Term {
                    low: (j + 3 * negative) as u8,
                    high: (j + 3 - 3 * negative) as u8,
                    factor: row[j] as f32,
                };
            }
            (map.offset_min[i], map.offset_max[i]) = around(offset - slack, offset + slack);
        }
        // False for NaN.
        (sum <= MAX_REACH).then_some(map)
    }

    /// The image of one box.
    #[inline]
    pub(crate) fn one(&self, one: &Aabb) -> Aabb {
        let (mut low, mut high) = (self.offset_min, self.offset_max);
        for i in 0..3 {
            for (j, term) in self.terms[i].iter().enumerate() {
                let (x, y) = (term.factor * one.min[j], term.factor * one.max[j]);
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
        let ends: [&Lanes; 6] = {
            let ([a, b, c], [d, e, f]) = (&source.min, &source.max);
            [a, b, c, d, e, f]
        };
        for i in 0..3 {
            let mut min = f32x8::splat(simd, self.offset_min[i]);
            let mut max = f32x8::splat(simd, self.offset_max[i]);
            for term in &self.terms[i] {
                let factor = f32x8::splat(simd, term.factor);
                min += ends[usize::from(term.low)].load(simd) * factor;
                max += ends[usize::from(term.high)].load(simd) * factor;
            }
            min.store_slice(&mut mapped.min[i].0);
            max.store_slice(&mut mapped.max[i].0);
        }
    }
}
