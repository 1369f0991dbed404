//! Eight boxes that move, and the times at which they overlap another one.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};

use super::{Aabb, BoxLanes, LANES};

/// More than the relative rounding error of a time: two differences, a sum, a quotient and a product (docs/numerics.md).
const TIME_ERROR: f32 = 8.0 * f32::EPSILON;

/// Eight boxes at the start and at the end of a motion: the children of a node, or triangles.
///
/// In between, the ends of a box are interpolated. The interpolated box contains what is in the box at both ends and moves on straight
/// lines: the smallest of several numbers that change linearly is never below the line between the smallest at the start and the smallest
/// at the end.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MovingLanes {
    pub(crate) start: BoxLanes,
    pub(crate) end: BoxLanes,
}

impl MovingLanes {
    pub(crate) fn set(&mut self, lane: usize, [start, end]: &[Aabb; 2]) {
        self.start.set(lane, start);
        self.end.set(lane, end);
    }

    /// Sets `hull` to the boxes that contain the whole motions. If either end of a motion is not finite, both ends and the hull become
    /// infinite.
    #[inline(always)]
    pub(crate) fn sweep<S: Simd>(&mut self, simd: S, hull: &mut BoxLanes) {
        let zero = f32x8::splat(simd, 0.0);
        let mut sum = zero;
        for axis in 0..3 {
            let (min, max) = (self.start.min[axis].load(simd), self.start.max[axis].load(simd));
            let (low, high) = (self.end.min[axis].load(simd), self.end.max[axis].load(simd));
            sum += (min - max) + (low - high);
            min.min(low).store_slice(&mut hull.min[axis].0);
            max.max(high).store_slice(&mut hull.max[axis].0);
        }
        // False for NaN and for infinities, in any of the numbers.
        let is_finite = (sum * zero).simd_eq(zero).to_bitmask() as u8;
        for lane in super::lanes_of(!is_finite) {
            self.set(lane, &[Aabb::UNBOUNDED; 2]);
            hull.set(lane, &Aabb::UNBOUNDED);
        }
    }

    /// The boxes that overlap a box of `other` at some time, as a bit mask. Also sets `enter` to a lower bound of the first such time of
    /// each. Boxes that are not finite overlap at all times.
    #[inline(always)]
    pub(crate) fn meet<S: Simd>(&self, simd: S, other: &Self, lane: usize, enter: &mut [f32; LANES]) -> u8 {
        let others = [other.start.get(lane), other.end.get(lane)];
        let [first, last] = &others;
        // Whether there is a gap between this box and the other one above it, or below it, at the start and at the end. Written without
        // closures, which would not be inlined here.
        let (mut apart, mut any_gap) = (mask32x8::splat(simd, false), mask32x8::splat(simd, false));
        for axis in 0..3 {
            let above_start = f32x8::splat(simd, first.min[axis]).simd_gt(self.start.max[axis].load(simd));
            let above_end = f32x8::splat(simd, last.min[axis]).simd_gt(self.end.max[axis].load(simd));
            let below_start = self.start.min[axis]
                .load(simd)
                .simd_gt(f32x8::splat(simd, first.max[axis]));
            let below_end = self.end.min[axis]
                .load(simd)
                .simd_gt(f32x8::splat(simd, last.max[axis]));
            apart |= (above_start & above_end) | (below_start & below_end);
            any_gap |= (above_start | above_end) | (below_start | below_end);
        }
        let near = !(apart.to_bitmask() as u8);
        if near & any_gap.to_bitmask() as u8 == 0 {
            // They overlap at both ends, and so at all times.
            *enter = [0.0; LANES];
            return near;
        }
        near & self.times(simd, &others, enter)
    }

    /// Does the work of [`MovingLanes::meet`] for boxes with a gap at the start or at the end.
    #[inline(always)]
    fn times<S: Simd>(&self, simd: S, [other_start, other_end]: &[Aabb; 2], enter: &mut [f32; LANES]) -> u8 {
        let zero = f32x8::splat(simd, 0.0);
        let early = f32x8::splat(simd, 1.0 - TIME_ERROR);
        let late = f32x8::splat(simd, 1.0 + TIME_ERROR);
        // Quotients may underflow.
        let tiny = f32x8::splat(simd, f32::MIN_POSITIVE);
        let most = f32x8::splat(simd, f32::MAX);
        let (mut first, mut last) = (zero, f32x8::splat(simd, 1.0));
        for axis in 0..3 {
            // The sizes of the gaps, negative where boxes overlap.
            let above_start = f32x8::splat(simd, other_start.min[axis]) - self.start.max[axis].load(simd);
            let above_end = f32x8::splat(simd, other_end.min[axis]) - self.end.max[axis].load(simd);
            let below_start = self.start.min[axis].load(simd) - f32x8::splat(simd, other_start.max[axis]);
            let below_end = self.end.min[axis].load(simd) - f32x8::splat(simd, other_end.max[axis]);
            for (start, end) in [(above_start, above_end), (below_start, below_end)] {
                let growth = end - start;
                let time = start / -growth;
                let (closes, opens) = (time * early - tiny, time * late + tiny);
                // Comparisons with NaN, from sizes out of range, are false. If only the growth is, the time is 0.
                first = (start.simd_gt(zero) & closes.simd_gt(first)).select(closes, first);
                let is_known = growth.simd_le(most);
                last = (end.simd_gt(zero) & is_known & opens.simd_lt(last)).select(opens, last);
            }
        }
        first.store_slice(enter);
        !(first.simd_gt(last).to_bitmask() as u8)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::Kernel;
    use crate::bounds::with_simd;

    fn moving(ends: [Aabb; 2]) -> MovingLanes {
        let mut boxes = MovingLanes::default();
        (0..LANES).for_each(|lane| boxes.set(lane, &ends));
        boxes
    }

    fn cube(at: Vec3) -> Aabb {
        Aabb { min: at, max: at + 0.5 }
    }

    /// The first time at which boxes meet. The same for all kernels and lanes.
    fn met(a: [Aabb; 2], b: [Aabb; 2]) -> Option<f32> {
        let (a, b) = (moving(a), moving(b));
        let answers: Vec<_> = Kernel::available()
            .iter()
            .map(|kernel| {
                let mut enter = [f32::NAN; LANES];
                let mask = with_simd!(kernel.level, simd => a.meet(simd, &b, 3, &mut enter));
                assert!(mask == 0 || mask == u8::MAX && enter == [enter[0]; LANES]);
                (mask != 0).then_some(enter[0])
            })
            .collect();
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
        answers[0]
    }

    #[test]
    fn boxes_that_cross_at_different_times_do_not_meet() {
        let still = [cube(Vec3::ZERO); 2];
        // Passes x = 0 to 0.5 in the first half, while y is far away.
        let past = [cube(Vec3::new(-1.0, 10.0, 0.0)), cube(Vec3::new(9.0, 0.0, 0.0))];
        assert_eq!(met(still, past), None);
        assert_eq!(met(past, still), None);
        // Leaves along x at 0.15, and arrives along y at 0.5.
        let through = [cube(Vec3::new(-1.0, 1.0, 0.0)), cube(Vec3::new(9.0, 0.0, 0.0))];
        assert_eq!(met(still, through), None);
        let hit = [cube(Vec3::new(-1.0, 0.0, 0.0)), cube(Vec3::new(9.0, 0.0, 0.0))];
        for enter in [met(still, hit), met(hit, still)] {
            assert!((0.0499..=0.05).contains(&enter.unwrap()), "{enter:?}");
        }
    }

    #[test]
    fn what_overlaps_at_the_start_meets_at_once() {
        let still = [cube(Vec3::ZERO); 2];
        let away = [cube(Vec3::splat(0.1)), cube(Vec3::splat(100.0))];
        assert_eq!(met(still, away), Some(0.0));
        assert_eq!(met([still[0], cube(Vec3::X * -5.0)], away), Some(0.0));
        assert_eq!(met(still, still), Some(0.0));
    }

    #[test]
    fn numbers_out_of_range_rule_nothing_out() {
        let still = [cube(Vec3::ZERO); 2];
        let all = Aabb::UNBOUNDED;
        let nan = Aabb {
            min: Vec3::NAN,
            max: Vec3::NAN,
        };
        let far = cube(Vec3::X * 10.0);
        for odd in [[all; 2], [all, far], [far, all], [nan; 2], [far, nan], [nan, far]] {
            assert!(met(still, odd).is_some_and(|enter| enter <= 0.5), "{odd:?}");
            assert!(met(odd, still).is_some_and(|enter| enter <= 0.5), "{odd:?}");
        }
        // The difference of two sizes, or a size itself, is larger than all numbers. The boxes meet at 1/2.
        let huge = f32::MAX;
        let wide = |min: f32, max: f32| Aabb {
            min: Vec3::new(min, 0.0, 0.0),
            max: Vec3::new(max, 1.0, 1.0),
        };
        assert!(met([wide(-0.75 * huge, -0.5 * huge), wide(0.75 * huge, huge)], still).is_some());
        assert!(met([wide(0.0, 0.75 * huge), wide(0.75 * huge, huge)], still).is_some());
        assert!(
            met(
                [wide(-huge, -huge), wide(huge, huge)],
                [wide(huge, huge), wide(-huge, -huge)]
            )
            .is_some()
        );
    }

    #[test]
    fn swept_boxes_contain_both_ends_and_are_infinite_if_either_is() {
        let at = |low: f32, high: f32| Aabb {
            min: Vec3::new(low, -low, low),
            max: Vec3::new(high, 2.0 - low, high),
        };
        for kernel in Kernel::available() {
            let mut boxes = moving([at(0.0, 1.0), at(10.0, 11.0)]);
            for (lane, odd) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].into_iter().enumerate() {
                boxes.set(2 * lane, &[at(odd, 1.0), at(-1.0, 1.0)]);
                boxes.set(2 * lane + 1, &[at(0.0, 1.0), at(odd, 1.0)]);
            }
            let mut hull = BoxLanes::default();
            with_simd!(kernel.level, simd => boxes.sweep(simd, &mut hull));
            for lane in 0..6 {
                assert_eq!(
                    [hull, boxes.start, boxes.end].map(|of| of.get(lane)),
                    [Aabb::UNBOUNDED; 3]
                );
            }
            let swept = Aabb {
                min: Vec3::new(0.0, -10.0, 0.0),
                max: Vec3::new(11.0, 2.0, 11.0),
            };
            assert_eq!(hull.get(7), swept);
            assert_eq!(boxes.end.get(7), at(10.0, 11.0));
        }
    }
}
