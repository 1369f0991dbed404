//! Avian's layers.

use avian3d::prelude::CollisionLayers;
use bevy_morph_collision::components::MorphCollisionLayers;

/// Converts between Avian's `CollisionLayers` and the layers of `bevy_morph_collision`, so that a game defines its layers once. Both decide in the same
/// way which colliders meet.
///
/// ```
/// use avian3d::prelude::*;
/// use bevy_morph_avian::prelude::*;
/// use bevy_morph_collision::prelude::*;
///
/// #[derive(PhysicsLayer, Clone, Copy, Default)]
/// enum GameLayer {
///     #[default]
///     Ground,
///     Player,
///     Enemy,
/// }
///
/// let layers = CollisionLayers::new(GameLayer::Player, [GameLayer::Ground, GameLayer::Enemy]);
/// assert_eq!(layers.to_morph(), MorphCollisionLayers::new(0b010, 0b101));
/// assert_eq!(CollisionLayers::from_morph(layers.to_morph()), layers);
/// ```
pub trait MorphAvianLayers {
    /// The same layers for collisions of `bevy_morph_collision`.
    fn to_morph(&self) -> MorphCollisionLayers;

    /// The same layers for the physics engine.
    fn from_morph(layers: MorphCollisionLayers) -> Self;
}

impl MorphAvianLayers for CollisionLayers {
    fn to_morph(&self) -> MorphCollisionLayers {
        MorphCollisionLayers::from_bits(self.memberships.0, self.filters.0)
    }

    fn from_morph(layers: MorphCollisionLayers) -> Self {
        Self::from_bits(layers.memberships, layers.filters)
    }
}
