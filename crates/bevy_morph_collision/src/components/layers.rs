//! Collision layers.

use std::ops::{BitAnd, BitOr, Not};

use bevy::prelude::*;

/// A set of layers, one bit per layer.
///
/// Wherever layers are wanted, a game can pass its own enum, several of its values, or plain bits:
///
/// ```
/// # use bevy_morph_collision::components::{MorphCollisionLayers, MorphLayerMask};
/// #[derive(Clone, Copy)]
/// enum GameLayer {
///     Player,
///     Enemy,
///     Ground,
/// }
///
/// impl From<GameLayer> for MorphLayerMask {
///     fn from(layer: GameLayer) -> Self {
///         Self::layer(layer as u32)
///     }
/// }
///
/// let player = MorphCollisionLayers::new(GameLayer::Player, [GameLayer::Enemy, GameLayer::Ground]);
/// let enemy = MorphCollisionLayers::new(GameLayer::Enemy, MorphLayerMask::ALL);
/// let wall = MorphCollisionLayers::new(0b100, 0b111);
/// assert!(player.interacts_with(enemy) && player.interacts_with(wall) && !player.interacts_with(player));
/// ```
///
/// With an enum that derives Avian's `PhysicsLayer`, the conversion is `Self(layer.to_bits())`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MorphLayerMask(pub u32);

impl MorphLayerMask {
    /// Every layer.
    pub const ALL: Self = Self(u32::MAX);
    /// No layer.
    pub const NONE: Self = Self(0);

    /// The layer with a number from 0 to 31.
    ///
    /// # Panics
    /// If the number is larger: there are 32 layers. In a constant, that is an error of the compiler.
    #[must_use]
    pub const fn layer(number: u32) -> Self {
        assert!(number < u32::BITS, "there are 32 layers, from 0 to 31");
        Self(1 << number)
    }
}

impl BitOr for MorphLayerMask {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitAnd for MorphLayerMask {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl Not for MorphLayerMask {
    type Output = Self;

    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl From<u32> for MorphLayerMask {
    fn from(bits: u32) -> Self {
        Self(bits)
    }
}

/// All of these layers together.
impl<L: Into<Self>, const N: usize> From<[L; N]> for MorphLayerMask {
    fn from(layers: [L; N]) -> Self {
        layers.map(Into::into).into_iter().fold(Self::NONE, BitOr::bitor)
    }
}

/// The layers that a collider is on and the layers that it collides with.
///
/// Two colliders are compared if each is on a layer that the other one collides with, as with `bevy_rapier`'s `CollisionGroups`
/// and Avian's `CollisionLayers`. By default everything is on all layers and collides with everything. (By default, Avian's colliders are
/// on the first layer only.)
///
/// ```
/// # use bevy_morph_collision::components::MorphCollisionLayers;
/// const FACES: u32 = 1;
/// const BALLS: u32 = 2;
/// let face = MorphCollisionLayers::new(FACES, BALLS);
/// let ball = MorphCollisionLayers::new(BALLS, [FACES, BALLS]);
/// assert!(face.interacts_with(ball) && !face.interacts_with(face));
/// ```
///
/// A [`MorphLayerMask`] can also be an enum of the game. `bevy_morph_avian` and `bevy_morph_rapier` convert to and from the layers of their
/// engines (`MorphAvianLayers`, `MorphRapierLayers`).
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Component, Debug, Default, Clone, PartialEq, Hash)]
pub struct MorphCollisionLayers {
    /// The layers that the collider is on, one bit per layer.
    pub memberships: u32,
    /// The layers that the collider collides with, one bit per layer.
    pub filters: u32,
}

impl MorphCollisionLayers {
    /// On every layer, and collides with every layer.
    pub const ALL: Self = Self::from_bits(u32::MAX, u32::MAX);
    /// On no layer, and collides with nothing.
    pub const NONE: Self = Self::from_bits(0, 0);

    /// Creates layers from memberships and filters.
    #[must_use]
    pub fn new(memberships: impl Into<MorphLayerMask>, filters: impl Into<MorphLayerMask>) -> Self {
        Self::from_bits(memberships.into().0, filters.into().0)
    }

    /// Creates layers from memberships and filters, one bit per layer.
    #[must_use]
    pub const fn from_bits(memberships: u32, filters: u32) -> Self {
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
        assert_eq!(
            MorphCollisionLayers::new([0b01_u32, 0b10, 0b10], MorphLayerMask::NONE).memberships,
            0b11
        );
        assert_eq!(MorphLayerMask::layer(31), MorphLayerMask(1 << 31));
        let (first, second) = (MorphLayerMask::layer(0), MorphLayerMask::layer(1));
        assert_eq!((first | second) & !first, second);
        assert!(!MorphCollisionLayers::NONE.interacts_with(MorphCollisionLayers::ALL));
    }
}
