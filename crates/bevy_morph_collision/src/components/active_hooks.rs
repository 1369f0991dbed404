//! Which colliders ask the hooks.

use bevy::prelude::*;

/// Asks the app's [hooks](crate::hooks::MorphCollisionHooks) about the pairs of this collider, or of all colliders of this body.
///
/// It is enough if one of the two colliders of a pair, or the body of one, has the component. Without it, hooks cost nothing.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # fn spawn(mut commands: Commands) {
/// commands.spawn((MorphShape::Ball { radius: 0.1 }, MorphActiveCollisionHooks::FILTER_PAIRS));
/// # }
/// # App::new().add_systems(Startup, spawn);
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphActiveCollisionHooks {
    /// Whether to call [`filter_pairs`](crate::hooks::MorphCollisionHooks::filter_pairs).
    pub filter_pairs: bool,
    /// Whether to call [`modify_contacts`](crate::hooks::MorphCollisionHooks::modify_contacts). Pairs are then compared in every run, even if
    /// neither collider has changed.
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
