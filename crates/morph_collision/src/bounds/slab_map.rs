//! The way of k-DOPs to another frame, outward.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::directions::{decompose, direction, length};
use super::frame::{LARGEST, MAP_ROUNDINGS};
use super::lanes::{greater, lesser};
use super::rounding::{U32, around};
use super::slabs::Slab;
use super::{Frame, Lanes};

/// A k-DOP's way to another frame: each end is an offset and at most three ends of the source.
#[derive(Clone, Debug)]
pub(crate) struct SlabMap<const H: usize> {
    terms: [[Term; 3]; H],
    pub(super) offset_min: [f32; H],
    pub(super) offset_max: [f32; H],
}

/// What an end of the source adds to both ends of a slab.
#[derive(Clone, Copy, Debug, Default)]
struct Term {
    /// Which of the source's ends, lower ones first, goes to the lower end, and which to the upper one.
    low: u8,
    high: u8,
    amount: f32,
}

impl<const H: usize> SlabMap<H> {
    /// `None` where `f32` cannot hold it.
    pub(super) fn new(frame: &Frame) -> Option<Self> {
        let mut map = Self {
            terms: [[Term::default(); 3]; H],
            offset_min: [0.0; H],
            offset_max: [0.0; H],
        };
        let rows = frame.linear.transpose();
        // Of everything, so that one comparison finds what is too large, or not a number.
        let mut sum = 0.0;
        for i in 0..H {
            let (row, offset, error) = if i < 3 {
                (rows.col(i), frame.translation[i], frame.error[i])
            } else {
                let normal = DVec3::from_array(direction(H, i).map(f64::from));
                (
                    rows * normal,
                    normal.dot(frame.translation),
                    normal.abs().dot(frame.error),
                )
            };
            // Ends along a slab are as large as its direction allows.
            let (terms, reach) = if H == 3 {
                ([(0, row.x), (1, row.y), (2, row.z)], row.abs().dot(frame.magnitude))
            } else {
                let terms = decompose(H, row);
                let end = |j: usize| {
                    let direction = DVec3::from_array(direction(H, j).map(f64::from));
                    direction.abs().dot(frame.magnitude)
                };
                (terms, terms.iter().map(|&(j, amount)| amount.abs() * end(j)).sum())
            };
            let reach = reach + offset.abs();
            let underflow = frame.underflow() * f64::from(length(H, i));
            let slack = error + MAP_ROUNDINGS * U32 * reach + underflow;
            let [(_, x), (_, y), (_, z)] = terms;
            sum += reach + slack + x.abs() + y.abs() + z.abs();
            for (entry, (j, amount)) in map.terms[i].iter_mut().zip(terms) {
                // A negative amount takes the upper end to the lower one.
                let negative = usize::from(amount < 0.0);
                *entry = Term {
                    low: (j + H * negative) as u8,
                    high: (j + H - H * negative) as u8,
                    amount: amount as f32,
                };
            }
            (map.offset_min[i], map.offset_max[i]) = around(offset - slack, offset + slack);
        }
        // Not "beyond", so that what is not a number is.
        (sum <= LARGEST).then_some(map)
    }

    /// One k-DOP.
    #[inline]
    pub(super) fn one(&self, one: &Slab<H>) -> Slab<H> {
        let mut mapped = Slab {
            min: self.offset_min,
            max: self.offset_max,
        };
        for i in 0..H {
            for (j, term) in self.terms[i].iter().enumerate() {
                // A box has a term for each axis, in order.
                let slab = if H == 3 { j } else { usize::from(term.low) % H };
                let (x, y) = (term.amount * one.min[slab], term.amount * one.max[slab]);
                mapped.min[i] += lesser(x, y);
                mapped.max[i] += greater(x, y);
            }
        }
        mapped
    }

    /// Eight of them, by their lower and upper ends.
    #[inline(always)]
    pub(super) fn all<S: Simd>(&self, simd: S, ends: &[[Lanes; H]; 2], mapped: &mut [[Lanes; H]; 2]) {
        let ends = ends.as_flattened();
        let [mins, maxs] = mapped;
        for i in 0..H {
            let mut min = f32x8::splat(simd, self.offset_min[i]);
            let mut max = f32x8::splat(simd, self.offset_max[i]);
            for term in &self.terms[i] {
                let amount = f32x8::splat(simd, term.amount);
                min += ends[usize::from(term.low)].load(simd) * amount;
                max += ends[usize::from(term.high)].load(simd) * amount;
            }
            min.store_slice(&mut mins[i].0);
            max.store_slice(&mut maxs[i].0);
        }
    }
}
