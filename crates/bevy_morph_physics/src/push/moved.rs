//! How a part of a surface moves in a step.

use bevy::math::DVec3;

use super::flight::Ground;
use crate::math::RigidMotion;

/// How a part moves in a step.
#[derive(Clone, Copy)]
pub(super) struct Moved {
    pub(super) motion: RigidMotion,
    /// The origin of the motion.
    pub(super) origin: DVec3,
    /// How much faster its vertices are than that, at most. Vertices far from the collider count less.
    pub(super) error: f64,
}

impl Moved {
    /// The motion of points at these positions that have these velocities.
    pub(super) fn fitted(points: &[DVec3], velocities: &[DVec3]) -> Self {
        let origin = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let points: Vec<DVec3> = points.iter().map(|point| *point - origin).collect();
        let weights = vec![1.0; points.len()];
        let motion = RigidMotion::fitted(&points, velocities, &weights);
        Self {
            motion,
            origin,
            error: motion.error(&points, velocities, &weights),
        }
    }

    /// The velocity of a point.
    pub(super) fn at(&self, point: DVec3) -> DVec3 {
        self.motion.at(point - self.origin)
    }

    /// What it does to a collider whose middle is at `point`, in `dt` seconds.
    pub(super) fn ground_at(&self, point: DVec3, dt: f32) -> Ground {
        Ground::Moving {
            way: self.at(point).as_vec3() * dt,
            turn: self.motion.angular.as_vec3() * dt,
            error: self.error as f32 * dt,
        }
    }
}
