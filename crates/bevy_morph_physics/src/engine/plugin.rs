//! Finds the physics engine in an app, adds the systems, and says what is missing.

use std::marker::PhantomData;

use bevy::app::AnimationSystems;
use bevy::ecs::schedule::InternedScheduleLabel;
use bevy::prelude::*;
use bevy_morph_collision::app::MorphCollisionSystems;
use bevy_morph_collision::contacts::MorphCollisions;
use bevy_morph_collision::physics_api::{add_skeletons, note_collider_component};
use tracing::error;

use super::attach::{attach_surfaces, detach_surface};
use super::frames::{after_steps, record_transforms};
use super::interface::{Engine, EngineNames};
use super::schedule::choose;
use super::teleport::note_teleport;
use crate::components::{
    EngineCheck, MorphCharacterGround, MorphPhysicsCollider, MorphPhysicsDiagnostics, MorphPhysicsScene, add_to_parts,
};
use crate::shape::{MeshLayouts, add_to_trees};
use crate::time::track_fixed_loop;

/// The systems of an engine's crate are there, or the log says what is missing.
#[derive(Resource)]
struct Settled<E: Engine>(PhantomData<E>);

/// Adds the systems of an engine's crate if the engine is there. Otherwise [`finish`] does, when all plugins are.
pub fn build<E: Engine>(app: &mut App, named: Option<InternedScheduleLabel>) {
    app.init_resource::<EngineCheck>();
    if E::is_present(app) && !E::schedules(app).is_empty() {
        install::<E>(app, named);
    }
}

/// Adds the systems of an engine's crate if that has not happened yet, and logs what is missing.
pub fn finish<E: Engine>(app: &mut App, named: Option<InternedScheduleLabel>) {
    let EngineNames {
        plugin,
        engine_plugin,
        engine_plugin_value,
        ..
    } = E::NAMES;
    if E::is_present(app) && !app.world().contains_resource::<Settled<E>>() {
        install::<E>(app, named);
    }
    if app.world().contains_resource::<MorphCollisions>() {
        note_collider_component::<MorphPhysicsCollider, MorphPhysicsScene>(app);
    } else {
        error!(
            "{plugin} does nothing without MorphCollisionPlugin, which builds its trees: write app.add_plugins(MorphPlugins)"
        );
    }
    if !E::is_present(app) {
        error!("{plugin} does nothing without {engine_plugin}: write app.add_plugins({engine_plugin_value})");
    }
    add_to_trees(app);
}

fn install<E: Engine>(app: &mut App, named: Option<InternedScheduleLabel>) {
    let EngineNames { plugin, step, .. } = E::NAMES;
    app.insert_resource(Settled::<E>(PhantomData));
    let found = E::schedules(app);
    if let Some(schedule) = choose(&found, named, &E::NAMES) {
        E::build(app, schedule);
    } else if found.is_empty() {
        error!(
            "{plugin} does nothing, because no schedule has a system in {step}: name the schedule to which you will add it, for example \
             {plugin}.in_schedule(FixedUpdate)"
        );
    }
}

/// Adds what every engine needs: types, observers, and the systems in `attach`, a set that the engine's crate puts before its engine reads
/// components, and at the end of frames.
///
/// `is_fixed` says whether physics runs in a fixed schedule. `None` if only the first step will show; then `runs_fixed` does.
pub fn add_systems<E: Engine, M>(
    app: &mut App,
    schedule: InternedScheduleLabel,
    attach: impl SystemSet + Clone,
    is_fixed: Option<bool>,
    runs_fixed: impl SystemCondition<M> + Clone,
) {
    track_fixed_loop(app);
    // Now, or later if the other plugin is added after this one.
    app.init_resource::<MeshLayouts>();
    add_to_trees(app);
    add_skeletons(app);
    app.register_type::<MorphPhysicsCollider>()
        .register_type::<MorphPhysicsScene>()
        .register_type::<MorphPhysicsDiagnostics>()
        .register_type::<MorphCharacterGround>()
        .init_resource::<MorphPhysicsDiagnostics>()
        .add_observer(detach_surface::<E>)
        .add_observer(note_teleport::<E>)
        .configure_sets(
            schedule,
            attach
                .clone()
                .after(AnimationSystems)
                // Trees that are finished in this frame are attached in the next one.
                .before(MorphCollisionSystems::Import),
        )
        .add_systems(schedule, (add_to_parts, attach_surfaces::<E>).chain().in_set(attach))
        .add_systems(
            PostUpdate,
            record_transforms::<E>
                .after(AnimationSystems)
                .after(TransformSystems::Propagate)
                .before(MorphCollisionSystems::Anchors),
        );
    if is_fixed != Some(false) {
        app.add_systems(FixedLast, after_steps::<E>.run_if(runs_fixed));
    }
}
