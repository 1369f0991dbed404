//! Tests world-space rays against a body's boxes.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x4};
use glam::DVec3;

use super::box_map::BoxMap;
use super::frame::to_world;
use super::inverse::Inverse;
use super::rounding::{U64, down};
use super::{BoxLanes, LANES, LowerBounds, PlacedBounds};

/// Half a unit in the last place of 1, in `f32`.
const U32: f64 = f32::EPSILON as f64 / 2.0;
/// Larger coordinates could overflow in `f32`. Nothing is culled then.
const MAX_REACH: f64 = 1e37;

/// A ray in the space of a body's boxes, or relative to the body's translation in the world if the body's map has no inverse.
///
/// Where the ray passes a point of the body at the parameter `t`, the point is within `error` of `origin + u direction` along each axis,
/// for `u = unit (t - start)`. The start is near the body, so that coordinates are as accurate as those of the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRay {
    pub(crate) origin: DVec3,
    /// The largest coordinate is at least 1 and less than 2.
    pub(crate) direction: DVec3,
    pub(crate) error: DVec3,
    /// The largest absolute coordinates of the body's points relative to any point up to the origin.
    pub(crate) reach: DVec3,
    start: f64,
    unit: f64,
    /// Whether the body's map has an inverse.
    pub(crate) is_in_model: bool,
}

impl LocalRay {
    /// The ray `origin + t direction`, for a placed body. `None` if coordinates are too large to compute with.
    pub(crate) fn new(origin: DVec3, direction: DVec3, body: &PlacedBounds) -> Option<Self> {
        /// Origins farther away than this, relative to the body, are moved along the ray. Not measured.
        const NEAR: f64 = 4.0;
        let world_from_model = body.world_from_model();
        let (inverse, magnitude, norm) = match world_from_model.inverse() {
            Some(inverse) => {
                let norm = (world_from_model.linear().abs() * DVec3::ONE).max_element();
                (inverse, body.magnitude(), norm)
            }
            None => (&Inverse::IDENTITY, body.spread(), 1.0),
        };
        let direction_in_model = inverse.linear * direction;
        let speed = direction_in_model.abs().max_element();
        if !(1e-250..=1e250).contains(&speed) {
            return None;
        }
        // The power of two below.
        let unit = f64::from_bits(speed.to_bits() & (0x7ff << 52));
        let direction_in_model = direction_in_model / unit;
        let (mut start, mut from_middle) = (0.0, origin - world_from_model.translation());
        let mut local = inverse.linear * from_middle;
        // A few roundings of these happen before the map to the model.
        let mut rounded = from_middle.abs().max_element();
        if local.abs().max_element() > NEAR * magnitude.max_element() {
            // Any number would do.
            let closest = -local.dot(direction_in_model) / direction_in_model.length_squared();
            start = (closest / unit).max(0.0);
            let along = direction * start;
            from_middle += along;
            rounded += along.abs().max_element();
            local = inverse.linear * from_middle;
        }
        let reach = magnitude + local.abs();
        let widest = reach.max_element();
        let world_error = body.error() + 4.0 * U64 * rounded;
        let world_reach = rounded + 2.0 * norm * widest;
        let error = inverse.rows * (2.0 * (world_error + 16.0 * U64 * world_reach))
            + DVec3::splat(inverse.error * (world_error + world_reach));
        // False for NaN.
        let is_usable = (error + reach).max_element() <= MAX_REACH && start * unit <= MAX_REACH;
        is_usable.then_some(Self {
            origin: local,
            direction: direction_in_model,
            error,
            reach,
            start,
            unit,
            is_in_model: world_from_model.inverse().is_some(),
        })
    }
}

/// A ray prepared for tests against the boxes of a body, in `f32`. `docs/numerics.md`, "Boxes and rays", derives the errors.
#[derive(Clone, Debug)]
pub(crate) struct RayCull {
    axes: [Slab; 3],
    /// Not above the `u` at which the ray begins.
    begin: f32,
    start: f64,
    unit_inverse: f64,
    /// The map of the boxes, if they are not in the space of the ray.
    map: Option<BoxMap>,
}

/// One axis of a [`RayCull`]: a box is entered at `(end - near) inverse` or later and left at `(other end - far) inverse` or earlier.
#[derive(Clone, Copy, Debug)]
struct Slab {
    near: f32,
    far: f32,
    inverse: f32,
    /// Whether the ray enters at the upper end.
    is_backward: bool,
}

impl RayCull {
    /// Nothing is culled without a local ray.
    pub(crate) fn new(ray: Option<&LocalRay>, body: &PlacedBounds) -> Self {
        let Some(ray) = ray else {
            return Self::of_everything();
        };
        let map = if ray.is_in_model { None } else { map_to_world(body) };
        if !ray.is_in_model && map.is_none() {
            return Self::of_everything();
        }
        let widest = ray.reach.max_element();
        let slab = |axis: usize| {
            Slab::new(
                ray.origin[axis],
                ray.direction[axis],
                ray.error[axis],
                ray.reach[axis],
                widest,
            )
        };
        Self {
            axes: [slab(0), slab(1), slab(2)],
            begin: down(-ray.start * ray.unit),
            start: ray.start,
            unit_inverse: 1.0 / ray.unit,
            map,
        }
    }

    fn of_everything() -> Self {
        let all = Slab {
            near: f32::INFINITY,
            far: f32::NEG_INFINITY,
            inverse: 1.0,
            is_backward: false,
        };
        Self {
            axes: [all; 3],
            begin: f32::NEG_INFINITY,
            start: 0.0,
            unit_inverse: 1.0,
            map: None,
        }
    }
}

/// The map of boxes to the world, relative to the body's translation.
#[cold]
fn map_to_world(body: &PlacedBounds) -> Option<BoxMap> {
    let (place, error) = (body.world_from_model(), DVec3::splat(body.error()));
    BoxMap::new(&to_world(place, place.translation(), body.magnitude(), error))
}

/// The images of boxes.
#[cold]
fn mapped<S: Simd>(simd: S, map: &BoxMap, boxes: &BoxLanes) -> BoxLanes {
    let mut mapped = BoxLanes::default();
    map.all(simd, boxes, &mut mapped);
    // NaN comes from boxes of infinite size.
    let bounded = |end: f32, unbounded: f32| if end.is_nan() { unbounded } else { end };
    for axis in 0..3 {
        let (min, max) = (&mut mapped.min[axis].0, &mut mapped.max[axis].0);
        *min = min.map(|end| bounded(end, f32::NEG_INFINITY));
        *max = max.map(|end| bounded(end, f32::INFINITY));
    }
    mapped
}

impl Slab {
    #[inline]
    fn new(origin: f64, speed: f64, error: f64, reach: f64, widest: f64) -> Self {
        /// Along slower axes, the ray moves by less than this share of the body while it passes it.
        const SLOW: f64 = 1.0 / (1_u64 << 60) as f64;
        let mut slack = error + 8.0 * U32 * (reach + error) + f64::from(f32::MIN_POSITIVE);
        let mut inverse = 1.0 / speed;
        if speed.abs() < SLOW {
            slack += 2.0 * SLOW * widest;
            inverse = 1.0 / SLOW;
        }
        let is_backward = inverse < 0.0;
        let towards = if is_backward { -slack } else { slack };
        Self {
            near: (origin + towards) as f32,
            far: (origin - towards) as f32,
            inverse: inverse as f32,
            is_backward,
        }
    }
}

impl LowerBounds for RayCull {
    #[inline(always)]
    fn lower_bounds<S: Simd>(&self, simd: S, boxes: &BoxLanes, lanes: u8, limit: f64, bounds: &mut [f64; LANES]) -> u8 {
        let in_world;
        let boxes = match &self.map {
            None => boxes,
            Some(map) => {
                in_world = mapped(simd, map, boxes);
                &in_world
            }
        };
        let mut enter = f32x8::splat(simd, self.begin);
        let mut leave = f32x8::splat(simd, f32::INFINITY);
        for (axis, slab) in self.axes.iter().enumerate() {
            let (low, high) = (&boxes.min[axis], &boxes.max[axis]);
            let (first, last) = if slab.is_backward { (high, low) } else { (low, high) };
            let inverse = f32x8::splat(simd, slab.inverse);
            enter = enter.max((first.load(simd) - f32x8::splat(simd, slab.near)) * inverse);
            leave = leave.min((last.load(simd) - f32x8::splat(simd, slab.far)) * inverse);
        }
        let missed = enter.simd_gt(leave).to_bitmask() as u8;
        let (start, unit) = (f64x4::splat(simd, self.start), f64x4::splat(simd, self.unit_inverse));
        let (zero, limit) = (f64x4::splat(simd, 0.0), f64x4::splat(simd, limit));
        let rounded_down = f64x4::splat(simd, 1.0 - 4.0 * U64);
        let (low, high) = enter.widen();
        let low = ((start + low * unit) * rounded_down).max(zero);
        let high = ((start + high * unit) * rounded_down).max(zero);
        low.store_slice(&mut bounds[..4]);
        high.store_slice(&mut bounds[4..]);
        let within = low.simd_le(limit).to_bitmask() | high.simd_le(limit).to_bitmask() << 4;
        within as u8 & !missed & lanes
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::bounds::{Aabb, Box64, Kernel, ModelPlane, WorldFromModel, levels, with_simd};

    fn bounds_of(place: &WorldFromModel, origin: DVec3, direction: DVec3, boxes: &BoxLanes) -> [f64; LANES] {
        let body = PlacedBounds::new(place, DVec3::splat(8.0));
        let cull = RayCull::new(LocalRay::new(origin, direction, &body).as_ref(), &body);
        let mut bounds = [0.0; LANES];
        let within = with_simd!(Kernel::default().level, simd => {
            cull.lower_bounds(simd, boxes, u8::MAX, f64::INFINITY, &mut bounds)
        });
        std::array::from_fn(|lane| {
            if within >> lane & 1 == 1 {
                bounds[lane]
            } else {
                f64::NAN
            }
        })
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
                    let local = LocalRay::new(DVec3::new(1e39, 0.0, 1.0), direction, &body);
                    let cull = RayCull::new(local.as_ref(), &body);
                    for &level in levels() {
                        let mut bounds = [f64::NAN; LANES];
                        let within =
                            with_simd!(level, simd => cull.lower_bounds(simd, &boxes, u8::MAX, 0.0, &mut bounds));
                        assert_eq!(
                            (bounds, within),
                            ([0.0; LANES], u8::MAX),
                            "{place:?} {magnitude} {direction}"
                        );
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
