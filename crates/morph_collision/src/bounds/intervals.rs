//! How far targets move the ends of boxes: intervals for each unit of weight, as 16-bit numbers rounded outward.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, u32x8};
use glam::Vec3;

use super::slopes::add_row;
use super::{Aabb, BoxLanes, LANES};

/// The sign, the exponent and seven bits of the fraction of an `f32`.
const UPPER_HALF: u32 = 0xffff_0000;

/// Between which displacements a target moves the points of a node's `W` children: a row of `W` words per axis.
///
/// A word has the upper halves of two `f32`: of the interval's lower end, then of its upper end. They are rounded outward, which
/// moves an end by less than 2^-7 of it, or by less than 2^-133 if it is subnormal. Rows are stored without gaps and read eight lanes
/// wide. Lanes without a child get meaningless numbers; callers mask them out.
#[derive(Clone, Copy)]
pub(crate) struct Intervals<'a, const W: usize>(&'a [u32]);

/// How many words the intervals of `width` children take.
pub(crate) const fn intervals_len(width: usize) -> usize {
    3 * width
}

impl<'a, const W: usize> Intervals<'a, W> {
    /// The intervals at an index of a list. The list must end with [`LANES`] unused words.
    #[inline(always)]
    pub(crate) fn at(list: &'a [u32], index: usize) -> Self {
        Self(&list[index * intervals_len(W)..][..2 * W + LANES])
    }
}

/// Appends the intervals of a node's children to a list. They must be coarse.
pub(crate) fn push_intervals(list: &mut Vec<u32>, intervals: &[Aabb]) {
    for axis in 0..3 {
        list.extend(intervals.iter().map(|interval| {
            let [min, max] = [interval.min, interval.max].map(|end| end[axis].to_bits());
            debug_assert_eq!((min | max) & !UPPER_HALF, 0, "{interval:?} is not coarse");
            min | max >> 16
        }));
    }
}

impl Aabb {
    /// The smallest box around this one whose coordinates are upper halves of `f32`.
    pub(crate) fn coarse(&self) -> Self {
        Self {
            min: Vec3::from_array(self.min.to_array().map(coarse_down)),
            max: -Vec3::from_array((-self.max).to_array().map(coarse_down)),
        }
    }
}

/// The largest upper half of an `f32` that is not above `value`.
fn coarse_down(value: f32) -> f32 {
    let bits = value.to_bits();
    // Without the lower half, the magnitude is smaller.
    let larger = if value < 0.0 { bits + !UPPER_HALF } else { bits };
    f32::from_bits(larger & UPPER_HALF)
}

impl BoxLanes {
    /// Adds the interval of a displacement, scaled by a weight of any sign. A negative weight moves lower ends by the largest
    /// displacement and upper ends by the smallest.
    #[inline(always)]
    pub(crate) fn add_interval<S: Simd, const W: usize>(&mut self, simd: S, weight: f32, intervals: Intervals<'_, W>) {
        if weight < 0.0 {
            self.add_ends::<S, W, true>(simd, weight, intervals);
        } else {
            self.add_ends::<S, W, false>(simd, weight, intervals);
        }
    }

    #[inline(always)]
    fn add_ends<S: Simd, const W: usize, const SWAP: bool>(
        &mut self,
        simd: S,
        weight: f32,
        Intervals(words): Intervals<'_, W>,
    ) {
        let weight = f32x8::splat(simd, weight);
        for axis in 0..3 {
            let words = u32x8::from_slice(simd, &words[axis * W..][..LANES]);
            let (min, max) = ((words & UPPER_HALF).bitcast(), (words << 16).bitcast());
            let (min, max) = if SWAP { (max, min) } else { (min, max) };
            add_row(simd, &mut self.min[axis], weight, min);
            add_row(simd, &mut self.max[axis], weight, max);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_numbers_are_the_nearest_ones_outward() {
        let values = [0.0, 1.0, 1.0 + f32::EPSILON, 0.1, 1e-40, 1e37, f32::MIN_POSITIVE];
        for value in values.into_iter().flat_map(|value| [value, -value]) {
            let below = coarse_down(value);
            assert_eq!(below.to_bits() & !UPPER_HALF, 0, "{value:e}");
            // The next coarse number in the direction of the value.
            let step = if value < 0.0 {
                below.to_bits() - 0x1_0000
            } else {
                below.to_bits() + 0x1_0000
            };
            assert!(
                below == value || (below..f32::from_bits(step)).contains(&value),
                "{value:e}: {below:e}"
            );
        }
    }
}
