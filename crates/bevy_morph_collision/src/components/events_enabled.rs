//! Which colliders get entity events.

use bevy::prelude::*;

/// Triggers entity events on this collider; the messages come for all colliders, with or without this component.
///
/// The events are [`MorphCollisionStart`](crate::events::MorphCollisionStart) and [`MorphCollisionEnd`](crate::events::MorphCollisionEnd), and on
/// a collider with [`MorphSelfCollisions`](crate::self_collisions::MorphSelfCollisions) those of its regions. Events of bodies need no
/// component.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionEventsEnabled;
