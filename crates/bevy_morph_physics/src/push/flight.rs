//! How a collider is expected to move in a step, relative to a surface.

use bevy::math::Vec3;
use parry3d::math::Pose as Isometry;

/// A body that moves by less than this in a step, relative to its smallest extent, overlaps a surface so little when it arrives
/// that contacts push it back out.
pub const FAST: f32 = 0.25;

/// How a collider is expected to move in a step.
#[derive(Clone, Copy)]
pub struct Flight {
    /// Where the collider is at the start of the step.
    pub isometry: Isometry,
    /// How its body moves.
    pub way: Vec3,
    /// How its body turns, in radians about an axis.
    pub turn: Vec3,
    /// How far its farthest point is from the centre of the turn.
    pub radius: f32,
}

/// How some triangles of a surface move near a collider in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// They do not move, or they jump: they are at their new place from the start.
    Still,
    /// They move.
    Moving {
        /// The translation at the collider.
        way: Vec3,
        /// The rotation, in radians about an axis.
        turn: Vec3,
        /// How much farther any of them moves.
        error: f32,
    },
}

impl Flight {
    /// How far its points move at most, relative to a surface.
    pub fn relative_to(&self, ground: &Ground) -> f32 {
        let (way, turn, more) = match *ground {
            Ground::Still => (self.way, self.turn, 0.0),
            Ground::Moving { way, turn, error } => (self.way - way, self.turn - turn, error),
        };
        way.length() + turn.length().min(2.0) * self.radius + more
    }
}
