//! Bounds for boxes in queries about one body, and tests of world-space half-spaces against a body's model-space boxes.

use fearless_simd::prelude::*;
use glam::DVec3;

use super::box_map::BoxMap;
use super::rounding::{U64, down, up};
use super::{Box64, BoxLanes, LANES, Lanes, PlacedBounds, lanes_of};

/// The keys of eight boxes or triangles.
pub(crate) type Keys = [f32; LANES];

/// Computes lower bounds, such as on a distance, for eight boxes or triangles at once.
///
/// Bounds are in `f32` and have units of their own, so they are called keys. They order boxes, and those whose key is above that of a
/// limit are certainly beyond the limit: [`LowerBounds::key`] has the slack for all rounding errors.
pub(crate) trait LowerBounds {
    /// The key of a limit.
    fn key(&self, limit: f64) -> f32;

    /// Sets the keys of the boxes in some lanes. Returns the bit mask of those that may contain something up to the limit, a key. The other
    /// keys are arbitrary.
    fn lower_bounds<S: Simd>(&self, simd: S, boxes: &BoxLanes, lanes: u8, limit: f32, keys: &mut Keys) -> u8;

    /// Likewise for triangles, given their corners in the space of the boxes.
    #[inline(always)]
    fn triangles<S: Simd>(&self, _: S, _corners: &[[Lanes; 3]; 3], _limit: f32, keys: &mut Keys) -> u8 {
        *keys = [f32::NEG_INFINITY; LANES];
        u8::MAX
    }
}

/// Lower bounds from a function of one box; `None` for boxes to skip.
pub(crate) struct ByBox<F>(pub(crate) F);

impl<F: Fn(&Box64) -> Option<f64>> LowerBounds for ByBox<F> {
    fn key(&self, limit: f64) -> f32 {
        up(limit)
    }

    #[inline(always)]
    fn lower_bounds<S: Simd>(&self, _: S, boxes: &BoxLanes, lanes: u8, limit: f32, keys: &mut Keys) -> u8 {
        let mut within = 0;
        for lane in lanes_of(lanes) {
            if let Some(lowest) = self.0(&Box64::of(&boxes.get(lane))) {
                keys[lane % LANES] = down(lowest);
                within |= u8::from(keys[lane % LANES] <= limit) << (lane % LANES);
            }
        }
        within
    }
}

/// The images of boxes.
#[cold]
pub(super) fn mapped<S: Simd>(simd: S, map: &BoxMap, boxes: &BoxLanes) -> BoxLanes {
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
