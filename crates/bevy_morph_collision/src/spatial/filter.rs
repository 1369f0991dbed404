use bevy::prelude::*;

use crate::collider::Placement;

/// Which colliders a spatial query looks at; by default all, whatever they collide with.
#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct MorphQueryFilter {
    /// Only colliders on at least one of these layers, a bit each; what they themselves collide with does not matter. All if `None`.
    pub mask: Option<u32>,
    /// Colliders to leave out, and bodies with all their colliders.
    pub excluded_entities: Vec<Entity>,
    /// Whether rays pass through triangles that they see from behind.
    pub only_front: bool,
}

impl MorphQueryFilter {
    /// Only colliders on at least one of some layers.
    #[must_use]
    pub fn from_mask(mask: u32) -> Self {
        Self::default().with_mask(mask)
    }

    /// All but some colliders or bodies.
    #[must_use]
    pub fn from_excluded_entities(excluded: impl IntoIterator<Item = Entity>) -> Self {
        Self::default().with_excluded_entities(excluded)
    }

    /// The same for colliders on at least one of some layers.
    #[must_use]
    pub fn with_mask(mut self, mask: u32) -> Self {
        self.mask = Some(mask);
        self
    }

    /// The same without some more colliders or bodies.
    #[must_use]
    pub fn with_excluded_entities(mut self, excluded: impl IntoIterator<Item = Entity>) -> Self {
        self.excluded_entities.extend(excluded);
        self
    }

    /// The same for rays that pass through triangles they see from behind.
    #[must_use]
    pub fn with_only_front(mut self) -> Self {
        self.only_front = true;
        self
    }

    pub(super) fn takes(&self, collider: Entity, placed: &Placement) -> bool {
        let excluded = &self.excluded_entities;
        self.mask.is_none_or(|wanted| wanted & placed.layers.memberships != 0)
            && !excluded.iter().any(|&out| out == collider || out == placed.body)
    }
}
