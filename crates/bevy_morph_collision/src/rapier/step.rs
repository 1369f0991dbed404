//! Moves surfaces to their pose at the end of Rapier's step, and makes them visible to queries again afterwards.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextEntityLink, RapierContextJoints, RapierContextSimulation, RapierRigidBodySet,
    SimulationToRenderTime,
};
use bevy_rapier3d::plugin::{RapierConfiguration, TimestepMode};
use bevy_rapier3d::prelude::{ColliderDisabled, CollisionEvent, ContactForceEvent, RapierColliderHandle, SolverGroups};

use super::MorphRapierCollider;
use super::attach::RapierSurface;
use super::forces::Stepped;
use super::link::Links;
use super::obstacles::Obstacles;
use super::stages::{Role, drive, follow, push, show, tell_too_large};
use super::timestep::{is_between_steps, is_one_step, stride, substep, time_ahead, whole_steps};
use super::touches::tell_whole;
use super::world::{Audience, Movers, Step, World};
use crate::components::MorphColliderDisabled;
use crate::physics::clock::{StepTime, Timing};
use crate::physics::drawn::Shows;
use crate::physics::part::Pace;
use crate::physics::passage::Budget;
use crate::physics::schedule::InFixedLoop;
use crate::physics::sources::Sources;

/// Counts of [`MorphRapierCollider`]s in the last physics step.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphRapierDiagnostics {
    /// Surfaces in physics, except those that are switched off, too large, or not at a finite position.
    pub surfaces: u32,
    /// Surfaces that moved or morphed.
    pub moving: u32,
    /// Parts of surfaces near dynamic bodies, or of surfaces on dynamic bodies near anything. Each part is a body in the physics
    /// world.
    pub parts: u32,
    /// Parts whose vertices were blended for the step.
    pub blended: u32,
    /// Fast bodies whose way was compared with the motion of triangles, so that they do not pass through.
    pub compared_bodies: u32,
    /// Fast bodies that were not compared, because others were already compared with 200,000 triangles. They may pass through.
    pub limited_bodies: u32,
    /// Time spent before and after the step.
    pub duration: Duration,
}

/// State shared by all surfaces.
#[derive(Resource, Default)]
pub(crate) struct Stepping {
    /// Whether a step is in progress.
    now: Arc<AtomicBool>,
    movers: Movers,
    /// What is linked during a step, for each physics world.
    links: HashMap<Entity, Links>,
    /// The colliders of bodies that were too large in the last step. They have been logged.
    too_large: HashSet<u128>,
    /// Whether Rapier has stepped since surfaces were prepared.
    has_stepped: bool,
    pub(super) timing: Timing,
}

impl Stepping {
    pub(super) fn new(timing: Timing) -> Self {
        Self { timing, ..default() }
    }
}

pub(super) type Contexts<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut RapierContextSimulation,
        &'static mut RapierContextColliders,
        &'static mut RapierContextJoints,
        &'static mut RapierRigidBodySet,
        &'static RapierConfiguration,
        &'static SimulationToRenderTime,
    ),
>;

pub(super) fn world<'a>(
    simulation: &'a mut RapierContextSimulation,
    colliders: &'a mut RapierContextColliders,
    joints: &'a mut RapierContextJoints,
    bodies: &'a mut RapierRigidBodySet,
) -> World<'a> {
    World {
        bodies: &mut bodies.bodies,
        colliders: &mut colliders.colliders,
        islands: &mut simulation.islands,
        impulse_joints: &mut joints.impulse_joints,
        multibody_joints: &mut joints.multibody_joints,
        soft_bodies: &mut bodies.soft_bodies,
        length_unit: simulation.integration_parameters.length_unit,
    }
}

/// Moves surfaces to where they will be at the end of the step, and creates parts for nearby bodies.
pub(super) fn before_step(
    mut contexts: Contexts,
    mut surfaces: Query<(
        Entity,
        &MorphRapierCollider,
        &mut RapierSurface,
        &RapierColliderHandle,
        &RapierContextEntityLink,
        Shows,
        Option<&SolverGroups>,
        (Has<MorphColliderDisabled>, Has<ColliderDisabled>),
    )>,
    mut sources: Sources,
    mode: Res<TimestepMode>,
    time: Res<Time>,
    inside: Res<InFixedLoop>,
    mut stepping: ResMut<Stepping>,
    mut diagnostics: ResMut<MorphRapierDiagnostics>,
) {
    let start = Instant::now();
    stepping.timing.learn(&inside);
    *diagnostics = MorphRapierDiagnostics::default();
    if surfaces.is_empty() {
        return;
    }
    let Stepping {
        now,
        movers,
        links,
        too_large,
        timing,
        has_stepped: stepped,
        ..
    } = &mut *stepping;
    *stepped = false;
    if timing.watch.was_set(&time) {
        for (_, _, mut surface, ..) in &mut surfaces {
            surface.following.drawn.pause();
        }
    }
    let mut share = None;
    let fixed_span = timing
        .is_fixed
        .then(|| timing.lag.span(time.elapsed_secs_f64(), time.delta_secs_f64()));
    let is_waiting = |configuration: &RapierConfiguration, dt: f32| {
        configuration.physics_pipeline_active && dt <= 0.0 && is_between_steps(&mode, &time)
    };
    let ahead = |behind: &SimulationToRenderTime| time_ahead(&mode, &time, behind.diff).0;
    if contexts
        .iter()
        .any(|(.., configuration, behind)| is_waiting(configuration, ahead(behind)))
    {
        // Nobody asks for the skeletons of its surfaces, but they must stay.
        sources.skeletons.outdate();
    } else {
        sources.skeletons.begin();
    }
    let (mut refused, mut has_stepped) = (HashSet::default(), false);
    for (context, mut simulation, mut colliders, mut joints, mut bodies, configuration, behind) in &mut contexts {
        let (dt, interpolated) = time_ahead(&mode, &time, behind.diff);
        let span = fixed_span.unwrap_or(interpolated);
        if !configuration.physics_pipeline_active || dt <= 0.0 {
            if !is_waiting(configuration, dt) {
                let surfaces = surfaces.iter_mut().filter(|surface| surface.2.context == Some(context));
                for (_, _, mut surface, _, _, shows, ..) in surfaces {
                    sources.rest(&mut surface.following, shows);
                }
            }
            continue;
        }
        let share = match span {
            Some(_) => 1.0,
            // The same for all contexts.
            None => *share.get_or_insert_with(|| timing.watch.share(stride(&mode, &time, dt))),
        };
        let time = StepTime { dt, span, share };
        now.store(true, Ordering::Release);
        has_stepped = true;
        let parameters = simulation.integration_parameters;
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        let count = surfaces.iter().len();
        movers.find(world.bodies, world.colliders, dt, count, &mut |collider| {
            if refused.insert(collider) && !too_large.contains(&collider) {
                tell_too_large(collider, &sources);
            }
        });
        let once = is_one_step(&mode, dt);
        let audience = Audience::of(&world, parameters.length_unit, once);
        let (mut to_link, mut obstacles) = (Vec::new(), None);
        for (entity, settings, mut surface, handle, link, shows, solver_groups, disabled) in &mut surfaces {
            let surface = &mut *surface;
            // A surface that came from another world in this frame still has its parts there.
            let is_elsewhere = link.0 != context || surface.context.is_some_and(|home| home != context);
            if is_elsewhere || !world.colliders.contains(handle.0) {
                continue;
            }
            surface.context = Some(context);
            surface.following.max_acceleration = settings.max_acceleration * parameters.length_unit;
            let (morph_disabled, collider_disabled) = disabled;
            let place = (entity, handle.0);
            let off = morph_disabled || !follow(surface, place, shows, time, &mut sources, &mut world);
            surface.switch(off, collider_disabled, world.colliders, handle.0);
            if off {
                surface.pushing.stop(&mut world);
                continue;
            }
            let Some(mut role) = Role::of(&surface.following, handle.0, solver_groups, &world, dt) else {
                continue;
            };
            diagnostics.surfaces += u32::from(role.is_enabled);
            diagnostics.moving += u32::from(role.is_enabled && surface.following.moves);
            let is_closed = show(surface, place, settings, &role, &sources, &mut world);
            if role.carrier.is_some() && obstacles.is_none() {
                obstacles = Some(Obstacles::find(&world, dt, count));
            }
            let step = Step {
                pace: Pace {
                    dt,
                    prediction: parameters.prediction_distance() + role.manners.contact_skin,
                },
                // The speed at which Rapier separates overlapping bodies.
                leaving: parameters.max_corrective_velocity().min(10.0 * parameters.length_unit),
                movers,
                obstacles: obstacles.as_ref(),
                audience: &audience,
                once: whole_steps(&mode, dt) <= 1,
                body: role.body,
                stepping: now,
            };
            diagnostics.blended += push(surface, &mut role, &step, &mut world);
            diagnostics.parts += surface.pushing.parts();
            drive(surface, handle.0, is_closed && settings.solid, &role, &step, &mut world);
            to_link.extend(role.carrier.into_iter().flat_map(|carrier| carrier.links));
        }
        // All at once, because a surface looks for everything joined to its body.
        let links = links.entry(context).or_default();
        links.join(to_link.into_iter(), dt, once, &mut world);
    }
    if has_stepped {
        *too_large = refused;
    }
    diagnostics.duration = start.elapsed();
}

/// Runs with Rapier's step, if the game lets it run.
pub(super) fn note_step(mut stepping: ResMut<Stepping>) {
    stepping.has_stepped = true;
}

/// Parts exist only during steps.
pub(super) fn after_step(
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
    mut diagnostics: ResMut<MorphRapierDiagnostics>,
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
        let Some(context) = surface.context else { continue };
        if let Ok((simulation, mut bodies, mut colliders, _)) = contexts.get_mut(context) {
            let RapierSurface { following, pushing, .. } = surface;
            let stepped = Stepped {
                narrow_phase: &simulation.narrow_phase,
                bodies: &bodies.bodies,
                colliders: &colliders.colliders,
                dt: substep(&mode, simulation.integration_parameters.dt),
            };
            pushing.tell_forces(&stepped, &mut |force| _ = forces.write(force));
            if pushing.repeats {
                repeating.insert(entity, context);
            }
            let world = (simulation, &mut bodies.bodies, &mut colliders.colliders);
            if stepping.has_stepped {
                pushing.hold_back(following, world, &mut budget);
            }
            pushing.finish(&following.surface, &mut bodies.bodies, &mut colliders.colliders);
        }
    }
    tell_whole(&repeating, &mut touches, |context| {
        let (simulation, _, colliders, _) = contexts.get(context).ok()?;
        Some((&simulation.narrow_phase, colliders))
    });
    diagnostics.compared_bodies = budget.compared;
    diagnostics.limited_bodies = budget.limited;
    diagnostics.duration += start.elapsed();
}

/// Gives every new context the dispatcher for surfaces, before the context has contacts and before a game can set another
/// dispatcher.
pub(super) fn teach_context(
    added: On<Add<RapierContextSimulation>>,
    mut contexts: Query<&mut RapierContextSimulation>,
) {
    if let Ok(mut context) = contexts.get_mut(added.entity) {
        context.set_query_dispatcher(super::MorphQueryDispatcher);
    }
}
