//! The way of boxes to another frame, outward.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::Vec3;

use super::frame::{LARGEST, MAP_ROUNDINGS};
use super::lanes::{greater, lesser};
use super::rounding::{U32, around};
use super::{Aabb, BoxLanes, Frame, Lanes};

/// An affine map of boxes: each end of the image is an offset and an end of the source for each axis.
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
    /// Which rows of [`BoxLanes`], lower ends first, go to the lower end and to the upper one.
    low: u8,
    high: u8,
    amount: f32,
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
        // Of everything, so that one comparison finds what is too large, or not a number.
        let mut sum = 0.0;
        for i in 0..3 {
            let (row, offset) = (rows.col(i), frame.translation[i]);
            let reach = row.abs().dot(frame.magnitude) + offset.abs();
            let slack = frame.error[i] + MAP_ROUNDINGS * U32 * reach + frame.underflow();
            sum += reach + slack + row.x.abs() + row.y.abs() + row.z.abs();
            for (j, term) in map.terms[i].iter_mut().enumerate() {
                // A negative amount takes the upper end to the lower one.
                let negative = usize::from(row[j] < 0.0);
                *term = Term {
                    low: (j + 3 * negative) as u8,
                    high: (j + 3 - 3 * negative) as u8,
                    amount: row[j] as f32,
                };
            }
            (map.offset_min[i], map.offset_max[i]) = around(offset - slack, offset + slack);
        }
        // Not "beyond", so that what is not a number is.
        (sum <= LARGEST).then_some(map)
    }

    /// The image of one box.
    #[inline]
    pub(crate) fn one(&self, one: &Aabb) -> Aabb {
        let (mut min, mut max) = (self.offset_min, self.offset_max);
        for i in 0..3 {
            for (j, term) in self.terms[i].iter().enumerate() {
                let (x, y) = (term.amount * one.min[j], term.amount * one.max[j]);
                min[i] += lesser(x, y);
                max[i] += greater(x, y);
            }
        }
        Aabb {
            min: Vec3::from_array(min),
            max: Vec3::from_array(max),
        }
    }

    /// The images of eight; what lanes without a child become does not matter.
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
                let amount = f32x8::splat(simd, term.amount);
                min += ends[usize::from(term.low)].load(simd) * amount;
                max += ends[usize::from(term.high)].load(simd) * amount;
            }
            min.store_slice(&mut mapped.min[i].0);
            max.store_slice(&mut mapped.max[i].0);
        }
    }
}
