//! Gives the plugin's state to entities with a component that knows nothing of it.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;

/// Makes every entity with a component `C` have a component `S`, whether `C` comes before or after the plugin.
pub(crate) fn require_state<C: Component, S: Component + Default>(app: &mut App) {
    if app.try_register_required_components::<C, S>().is_ok() {
        return;
    }
    // Bevy cannot add it, because there are entities with `C` already.
    app.add_observer(|added: On<Add<C>>, mut commands: Commands| {
        commands.entity(added.entity).try_insert_if_new(S::default());
    });
    let world = app.world_mut();
    let mut entities = world.query_filtered::<Entity, (With<C>, Without<S>, Allow<Disabled>)>();
    let entities: Vec<Entity> = entities.iter(world).collect();
    for entity in entities {
        world.entity_mut(entity).insert(S::default());
    }
}
