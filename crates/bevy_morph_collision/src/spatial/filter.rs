use bevy::prelude::*;

use crate::layers::MorphCollisionLayers;

/// Which colliders a spatial query looks at; by default all, whatever they collide with.
#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct MorphQueryFilter {
    /// Only colliders on at least one of these layers, a bit each; what they themselves collide with does not matter.
    pub layers: Option<u32>,
    /// Colliders to leave out, and bodies with all their colliders.
    pub excluded: Vec<Entity>,
    /// Whether rays pass through triangles that they see from behind.
    pub only_front: bool,
}

impl MorphQueryFilter {
    /// Only colliders on at least one of some layers.
    #[must_use]
    pub fn on_layers(memberships: u32) -> Self {
        Self {
            layers: Some(memberships),
            ..Self::default()
        }
    }

    /// The same without some colliders or bodies.
    #[must_use]
    pub fn without(mut self, excluded: impl IntoIterator<Item = Entity>) -> Self {
        self.excluded.extend(excluded);
        self
    }

    pub(super) fn takes(&self, collider: Entity, body: Entity, layers: MorphCollisionLayers) -> bool {
        self.layers.is_none_or(|wanted| wanted & layers.memberships != 0)
            && !self.excluded.iter().any(|&out| out == collider || out == body)
    }
}
