//! Boxes of eight triangles that move: how long they overlap the box of another triangle.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};
use glam::DVec3;

use crate::bounds::{Aabb, BoxLanes, Extent, LANES};

/// Larger coordinates could overflow in products. Such boxes are infinite.
const MAX_COORDINATE: f64 = 1e18;
/// More than the relative rounding error of a time: two differences, a sum, a quotient and a product.
const TIME_ERROR: f32 = 8.0 * f32::EPSILON;

/// The boxes of eight triangles at the start and at the end of a motion.
///
/// In between, the ends of a box are interpolated. The interpolated box contains the triangle: the smallest of several numbers that
/// change linearly is never below the line between the smallest at the start and the smallest at the end.
#[derive(Clone, Debug, Default)]
pub(super) struct MovingLanes {
    at: [BoxLanes; 2],
}

impl MovingLanes {
    /// Sets a triangle's box, from its corners relative to the observer. These are rounded once.
    pub(super) fn set(&mut self, lane: usize, ends: [[DVec3; 3]; 2]) {
        let boxes = ends.map(|corners| {
            let extent = Extent::of_triangle(&corners);
            // One rounding of a difference. Twice that, because this one is rounded, too; and for subnormal numbers.
            let around = |end: DVec3| end.abs() * (2.0 * f64::EPSILON) + DVec3::splat(1e-300);
            Extent {
                min: extent.min - around(extent.min),
                max: extent.max + around(extent.max),
            }
        });
        let is_small = |of: &Extent| of.min.abs().max(of.max.abs()).max_element() <= MAX_COORDINATE;
        let is_bounded = boxes.iter().all(is_small);
        for (at, extent) in self.at.iter_mut().zip(&boxes) {
            at.set(lane, &if is_bounded { extent.outward() } else { Aabb::UNBOUNDED });
        }
    }

    /// The triangles whose boxes overlap that of a triangle of `other` at some time, as a bit mask. Also sets `enter` to a lower bound
    /// of the first such time of each.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(&self, simd: S, other: &Self, lane: usize, enter: &mut [f32; LANES]) -> u8 {
        let (other_start, other_end) = (other.at[0].get(lane), other.at[1].get(lane));
        let zero = f32x8::splat(simd, 0.0);
        let early = f32x8::splat(simd, 1.0 - TIME_ERROR);
        let late = f32x8::splat(simd, 1.0 + TIME_ERROR);
        // Quotients may underflow.
        let tiny = f32x8::splat(simd, f32::MIN_POSITIVE);
        let (mut first, mut last) = (zero, f32x8::splat(simd, 1.0));
        let mut apart = mask32x8::splat(simd, false);
        let [own_start, own_end] = &self.at;
        for axis in 0..3 {
            // The gap between this box and the other one above it, and below it, at the start and at the end. Boxes overlap where neither
            // gap is positive. Written without closures, which would not be inlined here.
            let above_start = f32x8::splat(simd, other_start.min[axis]) - own_start.max[axis].load(simd);
            let above_end = f32x8::splat(simd, other_end.min[axis]) - own_end.max[axis].load(simd);
            let below_start = own_start.min[axis].load(simd) - f32x8::splat(simd, other_start.max[axis]);
            let below_end = own_end.min[axis].load(simd) - f32x8::splat(simd, other_end.max[axis]);
            for (start, end) in [(above_start, above_end), (below_start, below_end)] {
                let (at_start, at_end) = (start.simd_gt(zero), end.simd_gt(zero));
                apart |= at_start & at_end;
                let time = start / (start - end);
                first = at_start.select(first.max(time * early - tiny), first);
                last = at_end.select(last.min(time * late + tiny), last);
            }
        }
        apart |= first.simd_gt(last);
        first.store_slice(enter);
        !(apart.to_bitmask() as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kernel;
    use crate::bounds::with_simd;

    fn moving(ends: [[DVec3; 3]; 2]) -> MovingLanes {
        let mut boxes = MovingLanes::default();
        for lane in 0..LANES {
            boxes.set(lane, ends);
        }
        boxes
    }

    fn triangle(at: DVec3) -> [DVec3; 3] {
        [DVec3::ZERO, DVec3::new(0.5, 0.25, 0.0), DVec3::new(0.0, 0.5, 0.5)].map(|corner| at + corner)
    }

    fn met(a: [[DVec3; 3]; 2], b: [[DVec3; 3]; 2]) -> Option<f32> {
        let (a, b, mut enter) = (moving(a), moving(b), [0.0; LANES]);
        let found = Kernel::available()
            .iter()
            .map(|kernel| with_simd!(kernel.level, simd => a.meet(simd, &b, 3, &mut enter)));
        let masks: Vec<u8> = found.collect();
        assert!(
            masks
                .iter()
                .all(|&mask| mask == masks[0] && (mask == 0 || mask == u8::MAX))
        );
        (masks[0] != 0).then_some(enter[5])
    }

    #[test]
    fn boxes_that_cross_at_different_times_do_not_meet() {
        let still = [triangle(DVec3::ZERO); 2];
        // Passes x = 0 to 0.5 in the first half, while y is far away.
        let past = [
            triangle(DVec3::new(-1.0, 10.0, 0.0)),
            triangle(DVec3::new(9.0, 0.0, 0.0)),
        ];
        assert_eq!(met(still, past), None);
        assert_eq!(met(past, still), None);
        // Meets x at 0.05 and y at 0.5.
        let through = [
            triangle(DVec3::new(-1.0, 1.0, 0.0)),
            triangle(DVec3::new(9.0, 0.0, 0.0)),
        ];
        assert_eq!(met(still, through), None);
        let hit = [
            triangle(DVec3::new(-1.0, 0.0, 0.0)),
            triangle(DVec3::new(9.0, 0.0, 0.0)),
        ];
        let enter = met(still, hit).expect("meets");
        assert!((0.0499..=0.05).contains(&enter), "{enter}");
    }

    #[test]
    fn what_overlaps_at_the_start_meets_at_once() {
        let still = [triangle(DVec3::ZERO); 2];
        let away = [triangle(DVec3::splat(0.1)), triangle(DVec3::splat(100.0))];
        assert_eq!(met(still, away), Some(0.0));
        assert_eq!(met([still[0], triangle(DVec3::X * -5.0)], away), Some(0.0));
    }

    #[test]
    fn boxes_too_large_for_times_always_meet() {
        let still = [triangle(DVec3::ZERO); 2];
        let huge = [triangle(DVec3::X * 1e30), triangle(DVec3::X * 2e30)];
        assert_eq!(met(still, huge), Some(0.0));
        assert_eq!(met(huge, still), Some(0.0));
    }
}
