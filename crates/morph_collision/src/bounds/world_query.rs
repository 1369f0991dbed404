//! Rays and half-spaces of the world against a body's model-space boxes.

use glam::DVec3;

use super::frame::world_reach;
use super::rounding::U64;
use super::{Box64, GapFrame, WorldFromModel};

/// A ray of the world in a frame where it can be compared with a body's boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayCull {
    frame: GapFrame,
    origin: DVec3,
    direction: DVec3,
}

impl RayCull {
    /// The ray `origin + t direction`, for a body with model-space points within a magnitude; `None` if there is no frame.
    pub(crate) fn new(
        origin: DVec3,
        direction: DVec3,
        world_from_model: &WorldFromModel,
        magnitude: DVec3,
    ) -> Option<Self> {
        // Where the ray is near the body, no coordinate of `t direction` is larger than those of the body and the origin.
        let near = 2.0 * origin.abs() + world_reach(world_from_model, magnitude);
        let frame = *GapFrame::list(world_from_model, magnitude, &WorldFromModel::IDENTITY, near).first()?;
        let (origin, direction) = match &frame.frames.b {
            Some(to_model) => (
                to_model.linear * origin + to_model.translation,
                to_model.linear * direction,
            ),
            None => (origin, direction),
        };
        Some(Self {
            frame,
            origin,
            direction,
        })
    }

    /// Below the smallest `t >= 0` at which the ray is in a box; `None` if it never is.
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
        // What rounding did to the ends themselves is in the slack; this is for the quotients.
        let rounding = 8.0 * U64;
        (enter * (1.0 - rounding) <= leave * (1.0 + rounding)).then_some(enter * (1.0 - rounding))
    }
}

/// A half-space of the world in a body's own coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelPlane {
    normal: DVec3,
    offset: f64,
}

impl ModelPlane {
    /// The half-space `normal . x + offset >= 0` of the world, for model-space points within a magnitude; widened so that it
    /// holds every point of a triangle that meets the half-space.
    pub(crate) fn new(normal: DVec3, offset: f64, world_from_model: &WorldFromModel, magnitude: DVec3) -> Self {
        let linear = world_from_model.linear();
        let reach = normal.abs().dot(world_reach(world_from_model, magnitude)) + offset.abs();
        Self {
            normal: linear.transpose() * normal,
            offset: normal.dot(world_from_model.translation()) + offset + 64.0 * U64 * reach,
        }
    }

    /// Whether the half-space may hold a point of a box.
    #[inline]
    pub(crate) fn reaches(&self, bounds: &Box64) -> bool {
        self.normal.dot(bounds.center) + self.normal.abs().dot(bounds.half) + self.offset >= 0.0
    }
}
