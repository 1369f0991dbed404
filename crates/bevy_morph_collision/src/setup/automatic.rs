//! What [`MorphCollisionSettings::every_deforming_mesh`] gave to a mesh.

use crate::components::{MorphCollider, MorphColliderOf, MorphCollisionLayers, body_of};
use bevy::ecs::query::QueryData;
use bevy::prelude::*;

/// Marks a deforming mesh that the setting was applied to, and records what the setting gave it: nothing if the mesh already was
/// a collider.
///
/// It stays when the user removes the collider, so that the collider does not come back.
#[derive(Component, Clone, Copy, Default)]
pub(crate) struct Automatic {
    pub(super) collider: Option<MorphCollider>,
    pub(super) layers: bool,
    /// The body that the setting assigned, or the mesh itself.
    pub(super) body: Option<Entity>,
}

impl Automatic {
    /// Whether a collider is the one that the setting gave.
    pub(crate) fn gave_collider(&self, now: Option<&MorphCollider>) -> bool {
        self.collider.zip(now).is_some_and(|(given, now)| given.is_same(now))
    }

    /// Whether layers are those that came with the collider.
    pub(crate) fn gave_layers(&self, now: Option<&MorphCollisionLayers>) -> bool {
        self.layers && now == Some(&MorphCollisionLayers::default())
    }

    /// Whether a collider's body is the one that the setting gave.
    pub(crate) fn gave_body(&self, now: Entity) -> bool {
        self.body == Some(now)
    }
}

/// What the setting may give, as a mesh has it now.
#[derive(QueryData)]
pub(crate) struct Present {
    pub(super) collider: Option<&'static MorphCollider>,
    pub(super) layers: Option<&'static MorphCollisionLayers>,
    pub(super) body: Option<&'static MorphColliderOf>,
}

impl Automatic {
    /// Removes what was given: the collider even if the user changed it, the rest only if it is unchanged.
    pub(super) fn take_back(&self, mut entity: EntityCommands, present: &PresentItem) {
        if present.collider.is_none() {
            // The user removed it, so it must not come back with the setting.
            entity.try_insert(Self::default());
        } else {
            entity.try_remove::<Self>();
        }
        if self.collider.is_some() {
            entity.try_remove::<MorphCollider>();
        }
        if self.gave_layers(present.layers) {
            entity.try_remove::<MorphCollisionLayers>();
        }
        if self.gave_body(body_of(entity.id(), present.body)) {
            entity.try_remove::<MorphColliderOf>();
        }
    }
}
