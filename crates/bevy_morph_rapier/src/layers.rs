//! Rapier's groups.

use bevy_morph_collision::components::MorphCollisionLayers;
use bevy_rapier3d::prelude::{CollisionGroups, Group};

/// Converts between Rapier's `CollisionGroups` and the layers of `bevy_morph_collision`, so that a game defines its layers once. Both decide in the same
/// way which colliders meet.
///
/// `InteractionTestMode::Or`, with which one side's agreement is enough, has no counterpart: it becomes `And`, the default.
///
/// ```
/// use bevy_morph_collision::prelude::*;
/// use bevy_morph_rapier::prelude::*;
/// use bevy_rapier3d::prelude::*;
///
/// let groups = CollisionGroups::new(Group::GROUP_2, Group::GROUP_1 | Group::GROUP_3);
/// assert_eq!(groups.to_morph(), MorphCollisionLayers::new(0b010, 0b101));
/// assert_eq!(CollisionGroups::from_morph(groups.to_morph()), groups);
/// ```
pub trait MorphRapierLayers {
    /// The same layers for collisions of `bevy_morph_collision`.
    fn to_morph(&self) -> MorphCollisionLayers;

    /// The same layers for the physics engine.
    fn from_morph(layers: MorphCollisionLayers) -> Self;
}

impl MorphRapierLayers for CollisionGroups {
    fn to_morph(&self) -> MorphCollisionLayers {
        MorphCollisionLayers::from_bits(self.memberships.bits(), self.filters.bits())
    }

    fn from_morph(layers: MorphCollisionLayers) -> Self {
        let [memberships, filters] = [layers.memberships, layers.filters].map(Group::from_bits_retain);
        Self::new(memberships, filters)
    }
}
