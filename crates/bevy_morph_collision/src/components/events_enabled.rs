//! Which colliders get events.

use bevy::prelude::*;

/// Also triggers [`MorphCollisionStart`] and [`MorphCollisionEnd`] as entity events on this collider.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionEventsEnabled;
