//! The plugin: which systems run when.

use std::sync::Arc;

use bevy::app::AnimationSystems;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::mesh::mark_3d_meshes_as_changed_if_their_assets_changed;
use bevy::prelude::*;
use bevy_morph_physics::MorphSurface;
use bevy_morph_physics::engine::{
    self, Engine, EngineNames, add_systems, attach_surfaces, record_transforms, runs_fixed, schedules_with,
};
use bevy_morph_physics::shape::MeshLayout;
use bevy_morph_physics::time::Timing;
use bevy_rapier3d::control::KinematicCharacterController;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::systems::update_character_controls;
use bevy_rapier3d::plugin::{PhysicsSet, RapierContextInitialization, RapierTransformPropagateSet};
use bevy_rapier3d::prelude::{Collider, RapierColliderHandle};

use crate::characters::{Footing, MorphCharacterCarry, after_controllers, before_controllers, carry};
use crate::push::Pushing;
use crate::step::{Stepping, after_step, before_step, mark_moved_hierarchies, note_step, record_frame, set_dispatcher};
use crate::surface::{Rapier, RapierState, RapierSurface, refresh_surfaces, remove_parts, stop_absent};

/// Lets rigid bodies of `bevy_rapier3d` collide with every [`MorphPhysicsCollider`](crate::MorphPhysicsCollider).
///
/// Add it next to `MorphPlugins` and `RapierPhysicsPlugin`, in any order. It gives every new physics context a
/// [`MorphQueryDispatcher`](crate::MorphQueryDispatcher). It runs in the schedule in which Rapier steps, whichever that is.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphRapierPlugin;

/// A [`MorphRapierPlugin`] that knows the schedule in which Rapier steps.
#[derive(Clone, Copy, Debug)]
pub struct ScheduledMorphRapierPlugin(InternedScheduleLabel);

impl MorphRapierPlugin {
    /// Names the schedule in which Rapier steps. You only need this if the plugin cannot find it, because your game
    /// adds Rapier's systems to schedules itself after all plugins are there, or to several schedules.
    #[must_use]
    pub fn in_schedule(self, schedule: impl ScheduleLabel) -> ScheduledMorphRapierPlugin {
        ScheduledMorphRapierPlugin(schedule.intern())
    }
}

impl Plugin for MorphRapierPlugin {
    fn build(&self, app: &mut App) {
        engine::build::<Rapier>(app, None);
    }

    fn finish(&self, app: &mut App) {
        engine::finish::<Rapier>(app, None);
    }
}

impl Plugin for ScheduledMorphRapierPlugin {
    fn build(&self, app: &mut App) {
        engine::build::<Rapier>(app, Some(self.0));
    }

    fn name(&self) -> &str {
        // It is the same plugin.
        std::any::type_name::<MorphRapierPlugin>()
    }

    fn finish(&self, app: &mut App) {
        engine::finish::<Rapier>(app, Some(self.0));
    }
}

/// The system sets of the plugin, around Rapier's step. If your game runs Rapier's `PhysicsSet::StepSimulation` only under a condition,
/// give `BeforeStep` and `AfterStep` the same condition.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphRapierSystems {
    /// Gives colliders their surfaces, before Rapier reads its components.
    Attach,
    /// Reads morph weights and prepares the parts that bodies may touch. Just before Rapier's step.
    BeforeStep,
    /// Cleans up just after Rapier's step.
    AfterStep,
}

impl Engine for Rapier {
    type State = RapierState;
    type Collider = Collider;
    const NAMES: EngineNames = EngineNames {
        plugin: "MorphRapierPlugin",
        engine_plugin: "RapierPhysicsPlugin",
        engine_plugin_value: "RapierPhysicsPlugin::<NoUserData>::default()",
        step: "Rapier's `PhysicsSet::StepSimulation`",
    };

    fn is_present(app: &App) -> bool {
        app.world().contains_resource::<RapierContextInitialization>()
    }

    fn schedules(app: &App) -> Vec<InternedScheduleLabel> {
        schedules_with(app, PhysicsSet::StepSimulation)
    }

    fn build(app: &mut App, schedule: InternedScheduleLabel) {
        build(app, schedule);
    }

    fn is_surface(collider: &Collider) -> bool {
        collider.raw.as_shape::<MorphSurface>().is_some()
    }

    fn new_state(entity: Entity, layout: Arc<MeshLayout>) -> RapierState {
        RapierState::new(Pushing::new(entity, layout))
    }

    fn attach(entity: &mut EntityCommands, surface: &MorphSurface) {
        entity.try_insert(Collider::from(SharedShape::new(surface.clone())));
    }

    fn detach(entity: &mut EntityCommands, replaced: bool) {
        // Otherwise Rapier would keep its internal collider, which a surface may have switched off or taken out of the solver, and use it
        // for the next shape.
        if !replaced {
            entity.try_remove::<RapierColliderHandle>();
        }
    }
}

fn build(app: &mut App, schedule: InternedScheduleLabel) {
    let is_fixed = runs_fixed(app, schedule);
    let fixed = |stepping: Res<Stepping>| stepping.timing.is_fixed;
    add_systems::<Rapier, _>(app, schedule, MorphRapierSystems::Attach, is_fixed, fixed);
    app.register_type::<MorphCharacterCarry>()
        .insert_resource(Stepping::new(Timing::new(is_fixed)))
        .init_resource::<Footing>()
        .add_observer(set_dispatcher)
        .add_observer(remove_parts)
        .configure_sets(
            schedule,
            (
                MorphRapierSystems::Attach
                    .before(PhysicsSet::SyncBackend)
                    .before(mark_3d_meshes_as_changed_if_their_assets_changed),
                MorphRapierSystems::BeforeStep
                    .after(PhysicsSet::SyncBackend)
                    .before(PhysicsSet::StepSimulation),
                MorphRapierSystems::AfterStep
                    .after(PhysicsSet::StepSimulation)
                    .before(PhysicsSet::Writeback),
            ),
        )
        .add_systems(
            schedule,
            (
                refresh_surfaces
                    .in_set(MorphRapierSystems::Attach)
                    .after(attach_surfaces::<Rapier>),
                (stop_absent, before_step)
                    .chain()
                    .in_set(MorphRapierSystems::BeforeStep),
                note_step.in_set(PhysicsSet::StepSimulation),
                after_step.in_set(MorphRapierSystems::AfterStep),
                before_controllers
                    .in_set(PhysicsSet::SyncBackend)
                    .before(update_character_controls),
                (after_controllers, carry)
                    .chain()
                    .in_set(PhysicsSet::SyncBackend)
                    .after(update_character_controls)
                    .before(RapierTransformPropagateSet),
                mark_moved_hierarchies
                    .run_if(any_with_component::<RapierSurface>)
                    .in_set(PhysicsSet::SyncBackend)
                    .after(carry)
                    .before(RapierTransformPropagateSet),
            ),
        );
    let at_the_end = record_frame
        .after(AnimationSystems)
        .after(TransformSystems::Propagate)
        .before(record_transforms::<Rapier>);
    let before_steps = record_frame
        .in_set(MorphRapierSystems::BeforeStep)
        .after(stop_absent)
        .before(before_step);
    if is_fixed != Some(false) {
        app.add_systems(PostUpdate, at_the_end.run_if(fixed));
    }
    if is_fixed != Some(true) {
        app.add_systems(schedule, before_steps.run_if(not(fixed)));
    }
    // Has no effect if controllers already exist; those are carried if you add the component to them.
    let _too_late = app.try_register_required_components::<KinematicCharacterController, MorphCharacterCarry>();
}
