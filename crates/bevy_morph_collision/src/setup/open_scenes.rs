//! The scenes whose outcome is not known yet.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;

/// The roots of scenes whose outcome is not known yet.
#[derive(Resource, Default)]
pub(crate) struct OpenScenes(pub(super) EntityHashSet);

impl OpenScenes {
    pub(crate) fn open(&mut self, root: Entity) {
        self.0.insert(root);
    }
}
