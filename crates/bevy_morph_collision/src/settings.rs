//! What is set for the whole app.

use bevy::prelude::*;

use crate::collider::MorphCollider;

/// What the plugin does, for the whole app. May be changed at any time.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionSettings {
    /// Nothing is looked at and nothing is reported; contacts stay as they are, and spatial queries answer from the last run.
    pub paused: bool,
    /// How far pairs are apart is measured, and they are left alone until they could have come that far. Gains where bodies stay
    /// close to each other and seldom touch, costs where they touch; off by default (`docs/tried.md`). No answer depends on it.
    pub separation_cache: bool,
    /// Every mesh with morph weights becomes such a collider without being asked; all that hang on one root of the hierarchy
    /// are one body.
    pub every_morphing_mesh: Option<MorphCollider>,
}

/// Whether the plugin's systems run.
pub(crate) fn is_running(settings: Res<MorphCollisionSettings>) -> bool {
    !settings.paused
}
