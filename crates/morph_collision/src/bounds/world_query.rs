//! Tests world-space rays and half-spaces against a body's model-space boxes.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::rounding::U64;
use super::{Box64, BoxLanes, GapFrame, LANES, PlacedBounds, WorldFromModel};

/// Computes lower bounds, such as on a distance, for everything in a box, for all children of a node at once.
pub(crate) trait LowerBounds {
    /// Sets the first `count` numbers to the bounds of the first `count` boxes, or to NaN for boxes to skip. The other numbers are
    /// arbitrary.
    fn lower_bounds<S: Simd>(&self, simd: S, boxes: &BoxLanes, count: usize, bounds: &mut [f64; LANES]);
}

/// Lower bounds from a function of one box.
pub(crate) struct ByBox<F>(pub(crate) F);

impl<F: Fn(&Box64) -> Option<f64>> LowerBounds for ByBox<F> {
    #[inline(always)]
    fn lower_bounds<S: Simd>(&self, _: S, boxes: &BoxLanes, count: usize, bounds: &mut [f64; LANES]) {
        for (lane, bound) in bounds.iter_mut().enumerate().take(count) {
            *bound = self.0(&Box64::of(&boxes.get(lane))).unwrap_or(f64::NAN);
        }
    }
}

/// A world-space ray in a frame in which it can be tested against a body's boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayCull {
    frame: GapFrame,
    origin: DVec3,
    direction: DVec3,
}

/// Covers the roundings of quotients. The frame's slack covers those of the boxes' ends.
const ROUNDING: f64 = 8.0 * U64;

impl RayCull {
    /// The ray `origin + t direction`, for a placed body.
    pub(crate) fn new(origin: DVec3, direction: DVec3, body: &PlacedBounds) -> Self {
        // At points of the ray near the body, coordinates of `t direction` are at most the body's plus the origin's.
        let near = 2.0 * origin.abs() + body.world_reach();
        let frame = GapFrame::first(body, &PlacedBounds::new(&WorldFromModel::IDENTITY, near));
        Self {
            frame,
            origin: frame.image_of_b(&Box64::point(origin)).center,
            direction: frame.frames[1].map_or(direction, |to_model| to_model.linear * direction),
        }
    }

    /// The smallest `t >= 0` at which the ray is in each of four boxes, widened for rounding; NaN for boxes that it misses.
    #[inline(always)]
    fn enter<S: Simd>(&self, simd: S, min: [f64x4<S>; 3], max: [f64x4<S>; 3]) -> f64x4<S> {
        /// Axes along which the ray is slower, but not still, are ignored: the reciprocal would overflow.
        const SLOW: f64 = f64::from_bits((1023 - 500) << 52);
        let none = f64x4::splat(simd, f64::NEG_INFINITY);
        let zero = f64x4::splat(simd, 0.0);
        let (mut enter, mut leave) = (zero, f64x4::splat(simd, f64::INFINITY));
        for axis in 0..3 {
            let (speed, slack) = (self.direction[axis], f64x4::splat(simd, self.frame.slack[axis]));
            let origin = f64x4::splat(simd, self.origin[axis]);
            let (low, high) = (min[axis] - origin - slack, max[axis] - origin + slack);
            if speed == 0.0 {
                let apart = low.simd_gt(zero) | high.simd_lt(zero);
                leave = apart.select(none, leave);
            } else if speed.abs() >= SLOW {
                let inverse = f64x4::splat(simd, 1.0 / speed);
                let (low, high) = (low * inverse, high * inverse);
                enter = enter.max(low.min(high));
                leave = leave.min(low.max(high));
            }
        }
        // NaN comes from boxes of infinite size, which give no bound.
        let enter = enter.simd_ge(zero).select(enter, zero);
        let enter = enter * f64x4::splat(simd, 1.0 - ROUNDING);
        let missed = enter.simd_gt(leave * f64x4::splat(simd, 1.0 + ROUNDING));
        missed.select(f64x4::splat(simd, f64::NAN), enter)
    }
}

impl LowerBounds for RayCull {
    #[inline(always)]
    fn lower_bounds<S: Simd>(&self, simd: S, boxes: &BoxLanes, count: usize, bounds: &mut [f64; LANES]) {
        let zero = f64x4::splat(simd, 0.0);
        let (mut min, mut max) = ([[zero; 3]; 2], [[zero; 3]; 2]);
        if self.frame.maps_a() {
            for half in 0..2 {
                let (mut low, mut high) = ([[0.0; 4]; 3], [[0.0; 4]; 3]);
                for lane in 0..4 {
                    let Box64 { center, half } = self.frame.image_of_a(&Box64::of(&boxes.get(4 * half + lane)));
                    for axis in 0..3 {
                        low[axis][lane] = center[axis] - half[axis];
                        high[axis][lane] = center[axis] + half[axis];
                    }
                }
                for axis in 0..3 {
                    min[half][axis] = f64x4::from_slice(simd, &low[axis]);
                    max[half][axis] = f64x4::from_slice(simd, &high[axis]);
                }
            }
        } else {
            for axis in 0..3 {
                (min[0][axis], min[1][axis]) = boxes.min[axis].load(simd).widen();
                (max[0][axis], max[1][axis]) = boxes.max[axis].load(simd).widen();
            }
        }
        self.enter(simd, min[0], max[0]).store_slice(&mut bounds[..4]);
        if count > 4 {
            self.enter(simd, min[1], max[1]).store_slice(&mut bounds[4..]);
        }
    }
}

/// A world-space half-space in a body's model space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelPlane {
    normal: DVec3,
    offset: f64,
}

impl ModelPlane {
    /// The half-space `normal . x + offset >= 0` of world space, for a placed body. It is widened so that no rounding can
    /// exclude a point of the body that is in the half-space.
    pub(crate) fn new(normal: DVec3, offset: f64, body: &PlacedBounds) -> Self {
        let world_from_model = body.world_from_model();
        let reach = normal.abs().dot(body.world_reach()) + offset.abs();
        let error = normal.abs().element_sum() * body.error();
        Self {
            normal: world_from_model.linear().transpose() * normal,
            // There are a few roundings per term; 64 is safe.
            offset: normal.dot(world_from_model.translation()) + offset + 64.0 * U64 * reach + error,
        }
    }

    /// Whether any point of a box might be in the half-space.
    #[inline]
    pub(crate) fn reaches(&self, bounds: &Box64) -> bool {
        let farthest = self.normal.dot(bounds.center) + self.normal.abs().dot(bounds.half) + self.offset;
        // NaN comes from boxes of infinite size, which might reach any half-space.
        farthest >= 0.0 || farthest.is_nan()
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::bounds::{Aabb, Kernel, levels, with_simd};

    fn bounds_of(place: &WorldFromModel, origin: DVec3, direction: DVec3, boxes: &BoxLanes) -> [f64; LANES] {
        let body = PlacedBounds::new(place, DVec3::splat(8.0));
        let cull = RayCull::new(origin, direction, &body);
        let mut bounds = [f64::INFINITY; LANES];
        with_simd!(Kernel::default().level, simd => cull.lower_bounds(simd, boxes, LANES, &mut bounds));
        bounds
    }

    #[test]
    fn boxes_of_infinite_size_are_never_skipped() {
        let infinite = Aabb::UNBOUNDED;
        let mut boxes = BoxLanes::default();
        boxes.set_all(&infinite);
        let turn = Affine3A::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.0);
        for place in [Affine3A::IDENTITY, turn, Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))] {
            let place = WorldFromModel::new(place).expect("finite");
            // Infinite boxes make bodies infinite.
            for magnitude in [DVec3::INFINITY, DVec3::ONE] {
                let body = PlacedBounds::new(&place, magnitude);
                for direction in [DVec3::X, DVec3::new(0.3, -1.0, 0.5)] {
                    let cull = RayCull::new(DVec3::new(1e39, 0.0, 1.0), direction, &body);
                    for &level in levels() {
                        let mut bounds = [f64::NAN; LANES];
                        with_simd!(level, simd => cull.lower_bounds(simd, &boxes, LANES, &mut bounds));
                        assert_eq!(bounds, [0.0; LANES], "{place:?} {magnitude} {direction}");
                    }
                }
                let plane = ModelPlane::new(DVec3::X, -1e300, &body);
                assert!(plane.reaches(&Box64::of(&infinite)), "{place:?} {magnitude}");
            }
        }
    }

    #[test]
    fn a_box_around_a_point_of_the_ray_is_entered_before_and_a_small_one_hardly_before() {
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        for case in 0..4000 {
            let mut vector = |reach: f64| DVec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..reach)));
            let turn = Affine3A::from_axis_angle(vector(1.0).normalize().as_vec3(), 1.0);
            let (mut origin, mut direction) = (vector(4.0), vector(1.0));
            let is_flat = case % 4 == 0;
            match case % 5 {
                0 => direction.y = 0.0,
                1 => direction.y = f64::from_bits(1),
                _ => {}
            }
            // A transform without an inverse, so boxes are mapped to world space. The ray is in its plane.
            let place = if is_flat {
                (origin.y, direction.y) = (0.0, 0.0);
                Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))
            } else {
                turn
            };
            let place = WorldFromModel::new(place).expect("finite");
            let t = f64::from(case) / 1000.0;
            let world = origin + t * direction;
            let model = if is_flat {
                world
            } else {
                place.linear().inverse() * world
            };
            let mut boxes = BoxLanes::default();
            for lane in 0..LANES {
                let size = [1e-5, 0.5, 3.0][lane % 3];
                let (min, max) = ((model - size).as_vec3(), (model + size).as_vec3());
                boxes.set(lane, &Aabb { min, max });
            }
            let bounds = bounds_of(&place, origin, direction, &boxes);
            for (lane, bound) in bounds.into_iter().enumerate() {
                let size = [1e-5, 0.5, 3.0][lane % 3];
                let earliest = (t - 4.0 * size / direction.length()).max(0.0);
                assert!((earliest..=t).contains(&bound), "case {case}, lane {lane}: {bound} {t}");
            }
        }
    }

    #[test]
    fn boxes_beside_and_behind_the_ray_are_skipped_and_touched_ones_are_not() {
        let unit = Aabb {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        let mut boxes = BoxLanes::default();
        boxes.set_all(&unit);
        let bound = |origin, direction| bounds_of(&WorldFromModel::IDENTITY, origin, direction, &boxes)[5];
        for beside in [1.1, -1.1] {
            assert!(bound(DVec3::new(-3.0, beside, 0.0), DVec3::X).is_nan());
        }
        for touched in [1.0, -1.0] {
            let bound = bound(DVec3::new(-3.0, touched, 0.0), DVec3::X);
            assert!((1.999..=2.0).contains(&bound), "{bound}");
        }
        assert!(bound(DVec3::new(3.0, 0.0, 0.0), DVec3::X).is_nan());
        assert_eq!(bound(DVec3::ZERO, DVec3::new(0.3, -1.0, 0.2)), 0.0);
        // Flat boxes in a plane through the origin have no slack there.
        boxes.set_all(&Aabb {
            min: Vec3::new(1.0, 0.0, -1.0),
            max: Vec3::new(2.0, 0.0, 1.0),
        });
        let flat = bounds_of(&WorldFromModel::IDENTITY, DVec3::ZERO, DVec3::X, &boxes);
        assert!((0.999..=1.0).contains(&flat[0]), "{flat:?}");
        // A ray that is almost parallel to them.
        let slow = DVec3::new(1.0, f64::from_bits(1), 0.0);
        let flat = bounds_of(&WorldFromModel::IDENTITY, DVec3::ZERO, slow, &boxes);
        assert!((0.999..=1.0).contains(&flat[0]), "{flat:?}");
    }
}
