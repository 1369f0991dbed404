//! Tests world-space rays against a body's boxes.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::box_map::BoxMap;
use super::local::{LocalSpace, map_to_world};
use super::rounding::{MAX_REACH, U32, U64, down, up};
use super::world_query::mapped;
use super::{BoxLanes, Keys, LowerBounds, PlacedBounds};

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
        let space = LocalSpace::model(body).unwrap_or(LocalSpace::world(body));
        let direction_in_model = space.linear() * direction;
        let speed = direction_in_model.abs().max_element();
        if !(1e-250..=1e250).contains(&speed) {
            return None;
        }
        // The power of two below.
        let unit = f64::from_bits(speed.to_bits() & (0x7ff << 52));
        let direction_in_model = direction_in_model / unit;
        let (mut start, mut from_middle) = (0.0, origin - body.world_from_model().translation());
        let mut local = space.linear() * from_middle;
        // A few roundings of these happen before the map to the model.
        let mut rounded = from_middle.abs().max_element();
        if local.abs().max_element() > NEAR * space.magnitude.max_element() {
            // Any number would do.
            let closest = -local.dot(direction_in_model) / direction_in_model.length_squared();
            start = (closest / unit).max(0.0);
            let along = direction * start;
            from_middle += along;
            rounded += along.abs().max_element();
            local = space.linear() * from_middle;
        }
        let reach = space.magnitude + local.abs();
        let error = space.error(rounded, reach.max_element());
        // False for NaN.
        let is_usable = (error + reach).max_element() <= MAX_REACH && start * unit <= MAX_REACH;
        is_usable.then_some(Self {
            origin: local,
            direction: direction_in_model,
            error,
            reach,
            start,
            unit,
            is_in_model: space.is_in_model,
        })
    }
}

/// A ray prepared for tests against the boxes of a body, in `f32`. A key is the `u` at which the ray enters a box, or less. `docs/numerics.md`, "Boxes and rays", derives the errors.
#[derive(Clone, Debug)]
pub(crate) struct RayCull {
    axes: [Slab; 3],
    /// Not above the `u` at which the ray begins.
    begin: f32,
    start: f64,
    unit: f64,
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
            unit: ray.unit,
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
            unit: 1.0,
            map: None,
        }
    }
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
    fn key(&self, limit: f64) -> f32 {
        up((limit - self.start + 8.0 * U64 * (limit + self.start)) * self.unit)
    }

    #[inline(always)]
    fn lower_bounds<S: Simd>(&self, simd: S, boxes: &BoxLanes, lanes: u8, limit: f32, keys: &mut Keys) -> u8 {
        let in_world;
        let boxes = match &self.map {
            None => boxes,
            Some(map) => {
                in_world = mapped(simd, map, boxes);
                &in_world
            }
        };
        let mut enter = f32x8::splat(simd, self.begin);
        let mut leave = f32x8::splat(simd, limit);
        for (axis, slab) in self.axes.iter().enumerate() {
            let (low, high) = (&boxes.min[axis], &boxes.max[axis]);
            let (first, last) = if slab.is_backward { (high, low) } else { (low, high) };
            let inverse = f32x8::splat(simd, slab.inverse);
            enter = enter.max((first.load(simd) - f32x8::splat(simd, slab.near)) * inverse);
            leave = leave.min((last.load(simd) - f32x8::splat(simd, slab.far)) * inverse);
        }
        enter.store_slice(keys);
        let missed = enter.simd_gt(leave).to_bitmask() as u8;
        !missed & lanes
    }
}
