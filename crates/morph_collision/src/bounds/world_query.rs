//! Rays and half-spaces of world space against a body's model-space boxes.

use glam::DVec3;

use super::rounding::U64;
use super::{Box64, GapFrame, PlacedBounds, WorldFromModel};

/// A world-space ray in a frame where it can be compared with a body's boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayCull {
    frame: GapFrame,
    origin: DVec3,
    direction: DVec3,
}

impl RayCull {
    /// The ray `origin + t direction`, for a placed body; `None` if there is no frame.
    pub(crate) fn new(origin: DVec3, direction: DVec3, body: &PlacedBounds) -> Option<Self> {
        // Where the ray is near the body, no coordinate of `t direction` is larger than the body's plus the origin's.
        let near = 2.0 * origin.abs() + body.world_reach();
        let frame = *GapFrame::list(body, &PlacedBounds::new(&WorldFromModel::IDENTITY, near)).first()?;
        Some(Self {
            frame,
            origin: frame.image_of_b(&Box64::point(origin)).center,
            direction: frame.frames[1].map_or(direction, |to_model| to_model.linear * direction),
        })
    }

    /// A lower bound on the smallest `t >= 0` at which the ray is in a box; `None` if it never is.
    #[inline]
    pub(crate) fn enter(&self, bounds: &Box64) -> Option<f64> {
        let bounds = self.frame.image_of_a(bounds);
        let to_center = bounds.center - self.origin;
        let half = bounds.half + self.frame.slack;
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (center, half, speed) = (to_center[axis], half[axis], self.direction[axis]);
            if speed == 0.0 {
                if center.abs() > half {
                    return None;
                }
            } else {
                let ends = [(center - half) / speed, (center + half) / speed];
                enter = enter.max(ends[0].min(ends[1]));
                leave = leave.min(ends[0].max(ends[1]));
            }
        }
        // For the quotients. The slack covers the roundings of the boxes' ends.
        let rounding = 8.0 * U64;
        (enter * (1.0 - rounding) <= leave * (1.0 + rounding)).then_some(enter * (1.0 - rounding))
    }
}

/// A world-space half-space in a body's model space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelPlane {
    normal: DVec3,
    offset: f64,
}

impl ModelPlane {
    /// The half-space `normal . x + offset >= 0` of world space, for a placed body. It is widened to
    /// contain every point of a triangle that meets the half-space.
    pub(crate) fn new(normal: DVec3, offset: f64, body: &PlacedBounds) -> Self {
        let world_from_model = body.world_from_model();
        let reach = normal.abs().dot(body.world_reach()) + offset.abs();
        let error = normal.abs().element_sum() * body.error();
        Self {
            normal: world_from_model.linear().transpose() * normal,
            // A few roundings per term, 64 to be safe.
            offset: normal.dot(world_from_model.translation()) + offset + 64.0 * U64 * reach + error,
        }
    }

    /// Whether a point of a box may be in the half-space.
    #[inline]
    pub(crate) fn reaches(&self, bounds: &Box64) -> bool {
        self.normal.dot(bounds.center) + self.normal.abs().dot(bounds.half) + self.offset >= 0.0
    }
}
