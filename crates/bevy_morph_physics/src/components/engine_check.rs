//! Warns if the app has no plugin for a physics engine.

use std::marker::PhantomData;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::lifecycle::HookContext;
use bevy::ecs::query::Allow;
use bevy::ecs::world::DeferredWorld;
use bevy::prelude::*;
use bevy_morph_collision::physics_api::check_in_next_frame;
use tracing::warn;

/// An app has a plugin for an engine, or the log says that it lacks one.
#[derive(Resource, Default)]
pub(crate) struct EngineCheck;

/// A check for entities with a component waits for the next frame.
#[derive(Resource)]
struct Pending<C>(PhantomData<C>);

/// Warns in the next frame if the app has no plugin for a physics engine and the component still exists. Until then, the app may get the
/// plugin. Silent in apps without collision detection, such as editors.
pub(super) fn check_engine<C: Component>(mut world: DeferredWorld, _: HookContext) {
    if world.contains_resource::<EngineCheck>() || world.contains_resource::<Pending<C>>() {
        return;
    }
    world.commands().queue(|world: &mut World| {
        if !world.contains_resource::<Pending<C>>() {
            world.insert_resource(Pending::<C>(PhantomData));
            check_in_next_frame(world, warn_without_engine::<C>);
        }
    });
}

fn warn_without_engine<C: Component>(world: &mut World) {
    world.remove_resource::<Pending<C>>();
    if world.contains_resource::<EngineCheck>() {
        return;
    }
    let mut entities = world.query_filtered::<NameOrEntity, (With<C>, Allow<Disabled>)>();
    let Some(entity) = entities.iter(world).next() else {
        return;
    };
    warn!(
        "`{}` has no effect on entity `{entity}`, because the app lacks a plugin for a physics engine: write \
         app.add_plugins(MorphRapierPlugin), from bevy_morph_rapier, or app.add_plugins(MorphAvianPlugin), from bevy_morph_avian",
        ShortName::of::<C>()
    );
    world.init_resource::<EngineCheck>();
}
