//! What a scene gave to one of its parts.

use crate::components::{MorphCollider, MorphCollisionLayers};
use bevy::prelude::*;

/// What a scene gave to one of its parts. A field is `None` if the part had its own.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct ScenePart {
    /// The entity with the [`MorphColliderScene`](crate::components::MorphColliderScene).
    pub root: Entity,
    pub(super) collider: Option<MorphCollider>,
    pub(super) layers: Option<MorphCollisionLayers>,
    /// The body that the scene assigned; the part itself if it is the root.
    pub(super) body: Option<Entity>,
    pub(super) events: bool,
}
