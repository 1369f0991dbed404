//! Which colliders ask the hooks.

use std::ops::BitOr;

use bevy::prelude::*;

/// Asks the app's [hooks](crate::hooks::MorphCollisionHooks) about the pairs of this collider, or of all colliders of this body.
///
/// It is enough if one of the two colliders of a pair, or the body of one, has the component. Both hooks are called by
/// default.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # fn spawn(mut commands: Commands) {
/// commands.spawn((MorphShape::Ball { radius: 0.1 }, MorphActiveCollisionHooks::FILTER_PAIRS));
/// # }
/// # App::new().add_systems(Startup, spawn);
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphActiveCollisionHooks {
    /// Whether to call [`filter_pairs`](crate::hooks::MorphCollisionHooks::filter_pairs).
    pub filter_pairs: bool,
    /// Whether to call [`modify_contacts`](crate::hooks::MorphCollisionHooks::modify_contacts). Pairs whose boxes overlap are then compared in
    /// every run, even if neither collider has changed; and while there is such a pair, no run is left out because nothing has changed.
    pub modify_contacts: bool,
}

impl MorphActiveCollisionHooks {
    /// Calls [`filter_pairs`](crate::hooks::MorphCollisionHooks::filter_pairs) only.
    pub const FILTER_PAIRS: Self = Self {
        filter_pairs: true,
        modify_contacts: false,
    };
    /// Calls [`modify_contacts`](crate::hooks::MorphCollisionHooks::modify_contacts) only.
    pub const MODIFY_CONTACTS: Self = Self {
        filter_pairs: false,
        modify_contacts: true,
    };
    /// Calls both.
    pub const ALL: Self = Self {
        filter_pairs: true,
        modify_contacts: true,
    };
}

impl Default for MorphActiveCollisionHooks {
    fn default() -> Self {
        Self::ALL
    }
}

impl BitOr for MorphActiveCollisionHooks {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self {
            filter_pairs: self.filter_pairs || other.filter_pairs,
            modify_contacts: self.modify_contacts || other.modify_contacts,
        }
    }
}
