//! Which colliders a run has to look at.

use bevy::prelude::*;

/// Which colliders a run has to look at.
#[derive(Resource, Default)]
pub(crate) struct ColliderNews {
    /// Whether the colliders are others than in the last run, or have other components.
    pub(crate) are_others: bool,
    /// Whether the state is an earlier one since the last run. Then nobody knows what has changed since, so the next run looks at everything.
    pub(crate) is_restored: bool,
    /// Colliders whose pose was replaced, or got other weights or joints, since they were last placed. Some may be listed twice.
    pub(crate) reposed: Vec<Entity>,
    /// The colliders that changed in the last run: their state before it is not the current one.
    pub(crate) moved: Moved,
}

impl ColliderNews {
    /// The state is an earlier one.
    pub(crate) fn restore(&mut self) {
        *self = Self {
            is_restored: true,
            moved: Moved::All,
            ..default()
        };
    }
}

/// The colliders that changed in a run.
pub(crate) enum Moved {
    All,
    Some(Vec<Entity>),
}

impl Default for Moved {
    fn default() -> Self {
        Self::Some(Vec::new())
    }
}
