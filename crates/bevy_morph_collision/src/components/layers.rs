//! Collision layers.

use bevy::prelude::*;

/// The layers that a collider is on and the layers that it collides with, one bit per layer.
///
/// Two colliders are compared if each is on a layer that the other one collides with, as with `bevy_rapier`'s `CollisionGroups`
/// and Avian's `CollisionLayers`. By default everything collides with everything.
///
/// ```
/// # use bevy_morph_collision::components::MorphCollisionLayers;
/// const FACES: u32 = 1;
/// const BALLS: u32 = 2;
/// let face = MorphCollisionLayers::new(FACES, BALLS);
/// let ball = MorphCollisionLayers::new(BALLS, FACES | BALLS);
/// assert!(face.interacts_with(ball) && !face.interacts_with(face));
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Component, Debug, Default, Clone, PartialEq, Hash)]
pub struct MorphCollisionLayers {
    /// The layers that the collider is on.
    pub memberships: u32,
    /// The layers that the collider collides with.
    pub filters: u32,
}

impl MorphCollisionLayers {
    /// On every layer, and collides with every layer.
    pub const ALL: Self = Self::new(u32::MAX, u32::MAX);
    /// On no layer, and collides with nothing.
    pub const NONE: Self = Self::new(0, 0);

    /// Creates layers from memberships and filters.
    #[must_use]
    pub const fn new(memberships: u32, filters: u32) -> Self {
        Self { memberships, filters }
    }

    /// Whether two colliders on these layers are compared.
    #[must_use]
    pub const fn interacts_with(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}

impl Default for MorphCollisionLayers {
    fn default() -> Self {
        Self::ALL
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_have_to_agree() {
        let (player, wall) = (
            MorphCollisionLayers::new(0b01, 0b10),
            MorphCollisionLayers::new(0b10, 0b11),
        );
        assert!(player.interacts_with(wall) && wall.interacts_with(player));
        assert!(!player.interacts_with(player));
        let ghost = MorphCollisionLayers::new(0b01, 0b100);
        assert!(!ghost.interacts_with(wall) && !wall.interacts_with(ghost));
        assert!(!MorphCollisionLayers::NONE.interacts_with(MorphCollisionLayers::ALL));
    }
}
