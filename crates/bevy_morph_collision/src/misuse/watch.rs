//! Notes the entities to look at.

use bevy::ecs::archetype::ArchetypeEntity;
use bevy::ecs::component::ComponentId;
use bevy::prelude::*;

use crate::app::Suspects;

/// Notes entities that get a component of a bundle, and those that have one already: they may come before the plugin.
pub(super) fn watch<B: Bundle>(app: &mut App) {
    app.add_observer(|added: On<Add<B>>, mut suspects: ResMut<Suspects>| suspects.note(added.entity));
    let world = app.world_mut();
    let watched: Vec<ComponentId> = world.register_bundle::<B>().iter_explicit_components().collect();
    let mut there = Vec::new();
    for archetype in world.archetypes().iter() {
        if watched.iter().any(|&component| archetype.contains(component)) {
            there.extend(archetype.entities().iter().map(ArchetypeEntity::id));
        }
    }
    let mut suspects = world.resource_mut::<Suspects>();
    for entity in there {
        suspects.note(entity);
    }
}
