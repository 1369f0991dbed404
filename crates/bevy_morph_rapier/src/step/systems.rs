//! Moves surfaces to their pose at the end of Rapier's step, and makes them visible to queries again afterwards.

use std::sync::atomic::Ordering;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy_morph_physics::MorphPhysicsDiagnostics;
use bevy_morph_physics::engine::Sources;
use bevy_morph_physics::push::Budget;
use bevy_morph_physics::shape::MassBudget;
use bevy_morph_physics::time::{Span, StepTime, Timing};
use bevy_rapier3d::plugin::TimestepMode;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextJoints, RapierContextSimulation, RapierRigidBodySet,
};
use bevy_rapier3d::prelude::{CollisionEvent, ContactForceEvent};

use super::collision_events::report_whole_surfaces;
use super::context_step::{ContextStep, log_too_large};
use super::input::{Clocks, Surface};
use super::stepping::Stepping;
use crate::push::{ContactListeners, Contexts, SteppedWorld, world};
use crate::surface::RapierSurface;
use crate::timestep::{is_one_step, stride, substep, time_ahead, whole_steps};

/// Moves surfaces to where they will be at the end of the step, and creates parts for nearby bodies.
pub(crate) fn before_step(
    mut contexts: Contexts,
    mut surfaces: Query<Surface>,
    mut sources: Sources,
    clocks: Clocks,
    mut stepping: ResMut<Stepping>,
    mut diagnostics: ResMut<MorphPhysicsDiagnostics>,
) {
    let start = Instant::now();
    stepping.timing.learn(&clocks.inside);
    *diagnostics = MorphPhysicsDiagnostics::default();
    if surfaces.is_empty() {
        return;
    }
    let stepping = &mut *stepping;
    stepping.has_stepped = false;
    let Clocks { mode, time, .. } = &clocks;
    let fixed_span = read_clock(time, &mut stepping.timing, &mut surfaces);
    sources.skeletons.notice();
    let (mut refused, mut has_stepped, mut share) = (HashSet::default(), false, None);
    let mut masses = MassBudget::default();
    for (context, mut simulation, mut colliders, mut joints, mut bodies, configuration, behind) in &mut contexts {
        let (dt, interpolated) = time_ahead(mode, time, behind.diff);
        let span = fixed_span.unwrap_or(interpolated);
        if !configuration.physics_pipeline_active || dt <= 0.0 {
            if !clocks.is_waiting(configuration, behind) {
                rest(context, &mut surfaces, &mut sources);
            }
            continue;
        }
        let share = match span {
            Some(_) => 1.0,
            // The same for all contexts.
            None => *share.get_or_insert_with(|| stepping.timing.watch.share(stride(mode, time, dt))),
        };
        stepping.now.store(true, Ordering::Release);
        has_stepped = true;
        let parameters = simulation.integration_parameters;
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        let surface_count = surfaces.iter().len();
        stepping
            .movers
            .find(world.bodies, world.colliders, dt, surface_count, &mut |collider| {
                if refused.insert(collider) && !stepping.too_large.contains(&collider) {
                    log_too_large(collider, &sources);
                }
            });
        let is_single = is_one_step(mode, dt);
        let mut step = ContextStep {
            context,
            time: StepTime { dt, span, share },
            parameters,
            surface_count,
            once: whole_steps(mode, dt) <= 1,
            listeners: ContactListeners::of(&world, parameters.length_unit, is_single),
            obstacles: None,
            movers: &stepping.movers,
            masses: &mut masses,
            now: &stepping.now,
            links: Vec::new(),
        };
        for mut surface in &mut surfaces {
            step.prepare(&mut surface, &mut sources, &mut world, &mut diagnostics);
        }
        // All at once, because a surface looks for everything joined to its body.
        let to_link = step.links;
        let links = stepping.links.entry(context).or_default();
        links.join(to_link.into_iter(), dt, is_single, &mut world);
    }
    if has_stepped {
        stepping.too_large = refused;
    }
    diagnostics.duration = start.elapsed();
}

/// In a fixed schedule, returns the span of drawn frames that the step uses. If the clock was set, it does not say how long changes took:
/// they are no motion.
fn read_clock(time: &Time, timing: &mut Timing, surfaces: &mut Query<Surface>) -> Option<Option<Span>> {
    if timing.watch.was_set(time) {
        for mut it in surfaces {
            it.surface.moving.drawn.pause();
        }
    }
    let lag = &mut timing.lag;
    timing
        .is_fixed
        .then(|| lag.span(time.elapsed_secs_f64(), time.delta_secs_f64()))
}

/// Lets the surfaces of a physics world notice what changes while no steps come.
fn rest(context: Entity, surfaces: &mut Query<Surface>, sources: &mut Sources) {
    let at_rest = surfaces
        .iter_mut()
        .filter(|it| it.surface.state.context == Some(context));
    for mut it in at_rest {
        sources.rest(&mut it.surface.moving, &it.drawn_with);
    }
}

/// Runs with Rapier's step, if the game lets it run.
pub(crate) fn note_step(mut stepping: ResMut<Stepping>) {
    stepping.has_stepped = true;
}

/// Parts exist only during steps.
pub(crate) fn after_step(
    mut contexts: Query<(
        &RapierContextSimulation,
        &mut RapierRigidBodySet,
        &mut RapierContextColliders,
        &mut RapierContextJoints,
    )>,
    mut surfaces: Query<(Entity, &mut RapierSurface), Allow<Disabled>>,
    mut forces: MessageWriter<ContactForceEvent>,
    mut touches: MessageMutator<CollisionEvent>,
    mode: Res<TimestepMode>,
    mut stepping: ResMut<Stepping>,
    mut diagnostics: ResMut<MorphPhysicsDiagnostics>,
) {
    let start = Instant::now();
    stepping.links.retain(|&context, links| {
        let world = contexts.get_mut(context);
        if let Ok((_, mut bodies, _, mut joints)) = world {
            links.part(&mut bodies.bodies, &mut joints.multibody_joints);
            return true;
        }
        false
    });
    stepping.now.store(false, Ordering::Release);
    let (mut repeating, mut budget) = (HashMap::default(), Budget::default());
    for (entity, mut surface) in &mut surfaces {
        let surface = &mut *surface;
        let Some(context) = surface.state.context else { continue };
        if let Ok((simulation, mut bodies, mut colliders, _)) = contexts.get_mut(context) {
            let RapierSurface { moving, state, .. } = surface;
            let pushing = &mut state.pushing;
            let stepped = SteppedWorld {
                narrow_phase: &simulation.narrow_phase,
                bodies: &bodies.bodies,
                colliders: &colliders.colliders,
                dt: substep(&mode, simulation.integration_parameters.dt),
            };
            pushing.report_forces(&stepped, &mut |force| _ = forces.write(force));
            if pushing.repeats {
                repeating.insert(entity, context);
            }
            let (bodies, colliders) = (&mut bodies.bodies, &mut colliders.colliders);
            if stepping.has_stepped {
                pushing.move_back(moving, simulation, bodies, colliders, &mut budget);
            }
            pushing.finish(&moving.surface, bodies, colliders);
        }
    }
    report_whole_surfaces(&repeating, &mut touches, |context| {
        let (simulation, _, colliders, _) = contexts.get(context).ok()?;
        Some((&simulation.narrow_phase, colliders))
    });
    diagnostics.compared_bodies = budget.compared;
    diagnostics.limited_bodies = budget.limited;
    diagnostics.duration += start.elapsed();
}

/// Gives every new context the dispatcher for surfaces, before the context has contacts and before a game can set another
/// dispatcher.
pub(crate) fn set_dispatcher(
    added: On<Add<RapierContextSimulation>>,
    mut contexts: Query<&mut RapierContextSimulation>,
) {
    if let Ok(mut context) = contexts.get_mut(added.entity) {
        context.set_query_dispatcher(crate::queries::MorphQueryDispatcher);
    }
}
