//! Bounds for boxes in queries about one body, and tests of world-space half-spaces against a body's model-space boxes.

use fearless_simd::prelude::*;
use glam::DVec3;

use super::rounding::U64;
use super::{Box64, BoxLanes, LANES, PlacedBounds, lanes_of};

/// Computes lower bounds, such as on a distance, for everything in a box, for all children of a node at once.
pub(crate) trait LowerBounds {
    /// Sets the numbers to the bounds of the boxes in some lanes. Returns the bit mask of those whose bound is at most the limit. The other
    /// numbers are arbitrary.
    fn lower_bounds<S: Simd>(&self, simd: S, boxes: &BoxLanes, lanes: u8, limit: f64, bounds: &mut [f64; LANES]) -> u8;
}

/// Lower bounds from a function of one box; `None` for boxes to skip.
pub(crate) struct ByBox<F>(pub(crate) F);

impl<F: Fn(&Box64) -> Option<f64>> LowerBounds for ByBox<F> {
    #[inline(always)]
    fn lower_bounds<S: Simd>(&self, _: S, boxes: &BoxLanes, lanes: u8, limit: f64, bounds: &mut [f64; LANES]) -> u8 {
        let mut within = 0;
        for lane in lanes_of(lanes) {
            if let Some(lowest) = self.0(&Box64::of(&boxes.get(lane))) {
                bounds[lane % LANES] = lowest;
                within |= u8::from(lowest <= limit) << (lane % LANES);
            }
        }
        within
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
