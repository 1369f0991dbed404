use bevy::prelude::*;

use crate::layers::MorphCollisionLayers;

/// Which colliders a spatial query looks at; by default all.
#[derive(Clone, Debug, Default)]
pub struct MorphQueryFilter {
    /// The query's own layers: it looks at the colliders that it [interacts with](MorphCollisionLayers::interacts_with).
    pub layers: MorphCollisionLayers,
    /// Colliders to leave out, and bodies with all their colliders.
    pub excluded: Vec<Entity>,
}

impl MorphQueryFilter {
    /// Only colliders on one of some layers, which they may keep to themselves.
    #[must_use]
    pub fn on_layers(memberships: u32) -> Self {
        Self {
            layers: MorphCollisionLayers::new(u32::MAX, memberships),
            excluded: Vec::new(),
        }
    }

    /// The same without some colliders or bodies.
    #[must_use]
    pub fn without(mut self, excluded: impl IntoIterator<Item = Entity>) -> Self {
        self.excluded.extend(excluded);
        self
    }

    pub(super) fn takes(&self, collider: Entity, body: Entity, layers: MorphCollisionLayers) -> bool {
        self.layers.interacts_with(layers) && !self.excluded.iter().any(|&out| out == collider || out == body)
    }
}
