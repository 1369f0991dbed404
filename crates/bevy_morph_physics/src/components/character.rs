//! What characters know about the surface on which they stand.

use bevy::prelude::*;

/// The surface with a [`MorphPhysicsCollider`](crate::MorphPhysicsCollider) on which a character stands. Updated in each step.
///
/// When the character jumps, add the velocity to its own to let it fly along with the surface.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphCharacterGround {
    /// The surface's entity. `None` in the air and on any other ground.
    pub surface: Option<Entity>,
    /// The velocity of the surface below the character's feet during the last step, in world units per second. In the air it is zero,
    /// or the velocity that the character keeps.
    pub velocity: Vec3,
}
