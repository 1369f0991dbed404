//! State that all surfaces share.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy::ecs::entity::hash_map::EntityHashMap;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use bevy_morph_physics::time::Timing;

use crate::push::Movers;

/// State shared by all surfaces.
#[derive(Resource, Default)]
pub(crate) struct Stepping {
    /// Whether contacts are being computed.
    pub(super) now: Arc<AtomicBool>,
    pub(super) movers: Movers,
    /// Colliders that were too large in the last step. They have been logged.
    pub(super) too_large: HashSet<Entity>,
    /// Colliders that changed since the last step, and how far they reach in this one.
    pub(super) changed: Vec<(Entity, f32)>,
    /// Bodies inside solid surfaces, with the velocity changes that drive them out.
    pub(super) expelled: EntityHashMap<Vec3>,
    /// Whether there was a step since physics was last due.
    pub(super) has_stepped: bool,
    pub(crate) timing: Timing,
}

impl Stepping {
    pub(crate) fn new(timing: Timing) -> Self {
        Self { timing, ..default() }
    }
}
