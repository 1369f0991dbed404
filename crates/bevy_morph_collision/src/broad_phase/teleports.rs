//! The entities that were put somewhere else since the last run.

use crate::components::{MorphTeleported, with_descendants};
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// The entities that were put somewhere else since the last run.
#[derive(SystemParam)]
pub(crate) struct Teleports<'w, 's> {
    marked: Query<'w, 's, Entity, With<MorphTeleported>>,
    children: Query<'w, 's, &'static Children>,
    commands: Commands<'w, 's>,
}

impl Teleports<'_, '_> {
    /// Returns the marked entities with their descendants, and removes the marks.
    pub(crate) fn take(&mut self) -> EntityHashSet {
        let mut elsewhere = EntityHashSet::default();
        for entity in &self.marked {
            elsewhere.extend(with_descendants(entity, &self.children));
            self.commands.entity(entity).try_remove::<MorphTeleported>();
        }
        elsewhere
    }
}
