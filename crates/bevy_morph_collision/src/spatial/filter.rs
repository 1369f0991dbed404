//! Which colliders a query sees.

use bevy::ecs::entity::MapEntities;
use bevy::prelude::*;

use crate::components::MorphLayerMask;
use crate::state::Placement;

/// Which colliders a spatial query considers. The default is all of them; the layers they collide with do not matter.
#[derive(MapEntities, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct MorphQueryFilter {
    /// Only colliders on at least one of these layers, one bit per layer. The layers they collide with do not matter. `None`
    /// means all.
    pub mask: Option<u32>,
    /// Colliders to leave out. A body in this list leaves out all its colliders.
    #[entities]
    pub excluded_entities: Vec<Entity>,
    /// Rays pass through triangles that they would hit from behind.
    pub only_front: bool,
}

impl MorphQueryFilter {
    /// Only colliders on at least one of these layers.
    #[must_use]
    pub fn from_mask(mask: impl Into<MorphLayerMask>) -> Self {
        Self::default().with_mask(mask)
    }

    /// All colliders except these, which may also be bodies.
    #[must_use]
    pub fn from_excluded_entities(excluded: impl IntoIterator<Item = Entity>) -> Self {
        Self::default().with_excluded_entities(excluded)
    }

    /// Restricts the filter to colliders on at least one of these layers.
    #[must_use]
    pub fn with_mask(mut self, mask: impl Into<MorphLayerMask>) -> Self {
        self.mask = Some(mask.into().0);
        self
    }

    /// Leaves out more colliders or bodies.
    #[must_use]
    pub fn with_excluded_entities(mut self, excluded: impl IntoIterator<Item = Entity>) -> Self {
        self.excluded_entities.extend(excluded);
        self
    }

    /// Lets rays pass through triangles that they would hit from behind.
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
