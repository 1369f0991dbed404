//! The plugin: which systems run when.

use std::sync::Arc;

use avian3d::prelude::{
    Collider, NarrowPhaseSystems, PhysicsLengthUnit, PhysicsSchedule, PhysicsStepSystems, PhysicsSystems,
};
use bevy::app::AnimationSystems;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use bevy_morph_physics::MorphSurface;
use bevy_morph_physics::engine::{
    self, Engine, EngineNames, add_systems, attach_surfaces, record_transforms, runs_fixed, schedules_with,
};
use bevy_morph_physics::shape::MeshLayout;
use bevy_morph_physics::time::Timing;

use crate::characters::{Footing, MorphAvianCarry, carry, find_ground};
use crate::push::{MorphAvianPart, Pushing};
use crate::step::{
    Stepping, after_step, apply_expulsion, before_step, find_movers, record_frame, refresh_contacts, remove_parts,
    report_contacts, rest, stop_disabled, watch_clock,
};
use crate::surface::{Avian, AvianState, need_mass};
use crate::whole_surface::WholeSurface;

/// Lets rigid bodies of `avian3d` collide with every [`MorphPhysicsCollider`](crate::MorphPhysicsCollider).
///
/// Add it next to `MorphPlugins` and Avian's `PhysicsPlugins`, in any order. It runs in the schedule in which Avian steps, whichever that
/// is.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphAvianPlugin;

/// A [`MorphAvianPlugin`] that knows the schedule in which Avian steps.
#[derive(Clone, Copy, Debug)]
pub struct ScheduledMorphAvianPlugin(InternedScheduleLabel);

impl MorphAvianPlugin {
    /// Names the schedule in which Avian steps. You only need this if the plugin cannot find it, because your game
    /// runs Avian itself after all plugins are there, or in several schedules.
    #[must_use]
    pub fn in_schedule(self, schedule: impl ScheduleLabel) -> ScheduledMorphAvianPlugin {
        ScheduledMorphAvianPlugin(schedule.intern())
    }
}

impl Plugin for MorphAvianPlugin {
    fn build(&self, app: &mut App) {
        engine::build::<Avian>(app, None);
    }

    fn finish(&self, app: &mut App) {
        engine::finish::<Avian>(app, None);
    }
}

impl Plugin for ScheduledMorphAvianPlugin {
    fn build(&self, app: &mut App) {
        engine::build::<Avian>(app, Some(self.0));
    }

    fn name(&self) -> &str {
        // It is the same plugin.
        std::any::type_name::<MorphAvianPlugin>()
    }

    fn finish(&self, app: &mut App) {
        engine::finish::<Avian>(app, Some(self.0));
    }
}

/// The system sets of the plugin, around Avian's step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphAvianSystems {
    /// Gives colliders their surfaces, before Avian prepares its step. In the schedule of physics.
    Attach,
    /// Reads morph weights and prepares the parts that bodies may touch. In Avian's `PhysicsSchedule`, before its `First`.
    BeforeStep,
    /// Makes Avian recompute contacts where the surface changed. In Avian's narrow phase, before contacts are updated.
    BeforeContacts,
    /// Reports what touches surfaces, in the surfaces' names. In Avian's narrow phase, after contacts are updated.
    AfterContacts,
}

impl Engine for Avian {
    type State = AvianState;
    type Collider = Collider;
    const NAMES: EngineNames = EngineNames {
        plugin: "MorphAvianPlugin",
        engine_plugin: "PhysicsPlugins",
        engine_plugin_value: "PhysicsPlugins::default()",
        step: "Avian's `PhysicsSystems::StepSimulation`",
    };

    fn is_present(app: &App) -> bool {
        app.world().contains_resource::<PhysicsLengthUnit>() && app.get_schedule(PhysicsSchedule).is_some()
    }

    fn schedules(app: &App) -> Vec<InternedScheduleLabel> {
        schedules_with(app, PhysicsSystems::StepSimulation)
    }

    fn build(app: &mut App, schedule: InternedScheduleLabel) {
        build(app, schedule);
    }

    fn is_surface(collider: &Collider) -> bool {
        collider.shape().as_shape::<WholeSurface>().is_some()
    }

    fn new_state(_entity: Entity, layout: Arc<MeshLayout>) -> AvianState {
        AvianState::new(Pushing::new(layout))
    }

    fn attach(_entity: &mut EntityCommands, _surface: &MorphSurface) {
        // The first step gives it a shape.
    }

    fn detach(entity: &mut EntityCommands, replaced: bool) {
        if replaced {
            entity.try_remove::<Collider>();
        }
    }
}

fn build(app: &mut App, schedule: InternedScheduleLabel) {
    let is_fixed = runs_fixed(app, schedule);
    let fixed = |stepping: Res<Stepping>| stepping.timing.is_fixed;
    add_systems::<Avian, _>(app, schedule, MorphAvianSystems::Attach, is_fixed, fixed);
    app.register_type::<MorphAvianPart>()
        .register_type::<MorphAvianCarry>()
        .init_resource::<Footing>()
        .insert_resource(Stepping::new(Timing::new(is_fixed)))
        .add_observer(need_mass)
        .add_observer(remove_parts)
        .configure_sets(schedule, MorphAvianSystems::Attach.before(PhysicsSystems::First))
        .configure_sets(
            PhysicsSchedule,
            (
                MorphAvianSystems::BeforeStep.before(PhysicsStepSystems::First),
                MorphAvianSystems::BeforeContacts.in_set(NarrowPhaseSystems::First),
                MorphAvianSystems::AfterContacts.in_set(NarrowPhaseSystems::Last),
            ),
        )
        .add_systems(
            schedule,
            watch_clock
                .in_set(MorphAvianSystems::Attach)
                .after(attach_surfaces::<Avian>),
        )
        .add_systems(
            schedule,
            rest.after(PhysicsSystems::StepSimulation)
                .before(PhysicsSystems::Writeback),
        )
        // Avian rejects schedules whose systems have an ambiguous order. A game's own systems may be anywhere.
        .add_systems(
            PhysicsSchedule,
            (
                (find_ground, stop_disabled, find_movers, before_step, apply_expulsion)
                    .chain()
                    .in_set(MorphAvianSystems::BeforeStep)
                    .ambiguous_with_all(),
                refresh_contacts
                    .in_set(MorphAvianSystems::BeforeContacts)
                    .ambiguous_with_all(),
                report_contacts
                    .in_set(MorphAvianSystems::AfterContacts)
                    .ambiguous_with_all(),
                (after_step, carry)
                    .chain()
                    .after(PhysicsStepSystems::Solver)
                    .before(PhysicsStepSystems::Sleeping)
                    .ambiguous_with_all(),
            ),
        );
    let at_the_end = record_frame
        .after(AnimationSystems)
        .after(TransformSystems::Propagate)
        .before(record_transforms::<Avian>);
    if is_fixed != Some(false) {
        app.add_systems(PostUpdate, at_the_end.run_if(fixed));
    }
}
