//! State that all surfaces share.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use bevy_morph_physics::time::Timing;

use crate::push::{Links, Movers};

/// State shared by all surfaces.
#[derive(Resource, Default)]
pub(crate) struct Stepping {
    /// Whether a step is in progress.
    pub(super) now: Arc<AtomicBool>,
    pub(super) movers: Movers,
    /// What is linked during a step, for each physics world.
    pub(super) links: HashMap<Entity, Links>,
    /// The colliders of bodies that were too large in the last step. They have been logged.
    pub(super) too_large: HashSet<u128>,
    /// Whether Rapier has stepped since surfaces were prepared.
    pub(super) has_stepped: bool,
    pub(crate) timing: Timing,
}

impl Stepping {
    pub(crate) fn new(timing: Timing) -> Self {
        Self { timing, ..default() }
    }
}
