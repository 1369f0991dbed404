//! How fast bodies leave a solid surface.

use bevy::math::{DVec3, Vec3};

use crate::moving::{MovingSurface, SurfacePoint};

/// The speed at which something leaves, as a fraction of the maximum speed deep inside.
const EXIT_SHARE: f64 = 0.3;

/// How a collider that is inside leaves.
pub struct Exit {
    /// Where on the surface.
    pub(super) point: SurfacePoint,
    /// Where it leaves to.
    pub direction: DVec3,
    /// Its target speed in that direction, relative to the surface, and that of the last step; 0 if it was outside.
    pub(super) speed: f64,
    pub(super) expelled: f64,
}

/// How bodies are driven out.
#[derive(Clone, Copy)]
pub struct Drive {
    /// The maximum speed.
    pub limit: f32,
    /// The length of the step.
    pub dt: f32,
}

impl Exit {
    /// How much the speed in the exit direction, relative to the surface, has to change.
    pub fn change(&self, speed: f64) -> f64 {
        if speed < self.speed {
            self.speed - speed
        } else {
            // It slows down, but at most by as much as it was driven before.
            -(speed.min(self.expelled) - self.speed).max(0.0)
        }
    }

    /// How much a velocity has to change for the body to leave a surface that pushes with parts.
    pub fn change_of(&self, velocity: Vec3, moving: &mut MovingSurface) -> Vec3 {
        let surface = moving.velocity_at(self.point).unwrap_or_default();
        let speed = self.direction.dot(velocity.as_dvec3() - surface);
        (self.change(speed) * self.direction).as_vec3()
    }
}

impl Drive {
    /// The speed of something whose middle is this deep inside.
    ///
    /// It is slower if the middle may be outside after the step: from then on contacts push, and they do not reduce the velocity.
    /// In that step they may move it as far as it is driven.
    pub(super) fn speed(&self, depth: f64, size: f64) -> f64 {
        let step = 2.0 * f64::from(self.limit * self.dt);
        let share = ((depth - step) / size).clamp(EXIT_SHARE, 1.0);
        let at_once = (depth + size) / f64::from(self.dt);
        (share * f64::from(self.limit)).min(at_once)
    }
}
