//! Moves surfaces to their pose at the end of Rapier's step, and makes them visible to queries again afterwards.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::mesh::morph::MorphWeights;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextEntityLink, RapierContextJoints, RapierContextSimulation, RapierRigidBodySet,
    SimulationToRenderTime,
};
use bevy_rapier3d::plugin::{RapierConfiguration, TimestepMode};
use bevy_rapier3d::prelude::{ColliderDisabled, CollisionEvent, ContactForceEvent, RapierColliderHandle, SolverGroups};
use bevy_rapier3d::rapier::dynamics::RigidBody;
use bevy_rapier3d::rapier::geometry::InteractionGroups;
use tracing::error;

use super::MorphRapierCollider;
use super::ahead::ahead;
use super::attach::RapierSurface;
use super::forces::Stepped;
use super::link::{Carrier, Links};
use super::obstacles::Obstacles;
use super::timestep::{is_one_step, substep, time_ahead};
use super::touches::tell_whole;
use super::world::{Audience, Manners, Movers, Step, World, no_push};
use crate::collider::MorphColliderDisabled;
use crate::physics::ahead::{is_rigid, rigid_place};
use crate::physics::begin::{Sides, advance, set_sides};
use crate::physics::clock::Lag;
use crate::physics::drawn::Shows;
use crate::physics::part::Pace;
use crate::physics::range::MAX_COORDINATE;
use crate::skeletons::{BindPoses, Skeletons};

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
    /// Whether physics runs in a fixed schedule.
    pub(super) is_fixed: bool,
    /// In that case, how far physics is behind what is drawn.
    pub(super) lag: Lag,
}

impl Stepping {
    pub(super) fn new(is_fixed: bool) -> Self {
        Self { is_fixed, ..default() }
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
    shared: Query<&MorphWeights>,
    globals: Query<&GlobalTransform>,
    bind_poses: Option<Res<BindPoses>>,
    mut skeletons: Local<Skeletons>,
    names: Query<NameOrEntity>,
    mode: Res<TimestepMode>,
    time: Res<Time>,
    mut stepping: ResMut<Stepping>,
    mut diagnostics: ResMut<MorphRapierDiagnostics>,
) {
    let start = Instant::now();
    *diagnostics = MorphRapierDiagnostics::default();
    if surfaces.is_empty() {
        return;
    }
    let Stepping {
        now,
        movers,
        links,
        too_large,
        is_fixed,
        lag,
    } = &mut *stepping;
    let fixed_span = is_fixed.then(|| lag.span(time.elapsed_secs_f64(), time.delta_secs_f64()));
    let name_of = |entity| names.get(entity).map(|name| name.to_string()).unwrap_or_default();
    let (mut refused, mut has_stepped) = (HashSet::default(), false);
    let mut refuse = |collider: u128| {
        if refused.insert(collider) && !too_large.contains(&collider) {
            let name = Entity::try_from_bits(collider as u64).map(name_of).unwrap_or_default();
            error!(
                "the collider of entity `{name}` is more than {MAX_COORDINATE:e} units large, or moves that far in a step: no deforming \
                 surface pushes it; make it smaller"
            );
        }
    };
    for (context, mut simulation, mut colliders, mut joints, mut bodies, configuration, behind) in &mut contexts {
        let (dt, interpolated) = time_ahead(&mode, &time, behind.diff);
        let span = fixed_span.unwrap_or(interpolated);
        if !configuration.physics_pipeline_active || dt <= 0.0 {
            continue;
        }
        now.store(true, Ordering::Release);
        if !has_stepped {
            // Not in frames without a step: a pause would drop the skeletons.
            skeletons.begin();
        }
        has_stepped = true;
        let parameters = simulation.integration_parameters;
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        let count = surfaces.iter().len();
        movers.find(world.bodies, world.colliders, dt, count, &mut refuse);
        let once = is_one_step(&mode, dt);
        let audience = Audience::of(&world, parameters.length_unit, once);
        let (mut to_link, mut obstacles) = (Vec::new(), None);
        for (entity, settings, mut surface, handle, link, (place, weights, skin), solver_groups, disabled) in
            &mut surfaces
        {
            if link.0 != context {
                continue;
            }
            let surface = &mut *surface;
            let Some(collider) = world.colliders.get(handle.0) else {
                continue;
            };
            if surface.context.is_some_and(|home| home != context) {
                // It came from another world in this frame, and its parts are still there.
                continue;
            }
            surface.context = Some(context);
            let (morph_disabled, collider_disabled) = disabled;
            let mut off = morph_disabled;
            if !morph_disabled {
                let RapierSurface {
                    following, bad_place, ..
                } = &mut *surface;
                let is_skinned = following.is_skinned();
                let drawn = &mut following.drawn;
                let skin = skin.filter(|_| is_skinned);
                let mut live = drawn.live(place, skin, &mut skeletons, bind_poses.as_deref(), &globals);
                drawn.stands_alone = collider.parent().is_none();
                if let Some(span) = span {
                    drawn.at_step(&live);
                    live = drawn.at(span.end, live);
                }
                let ahead = ahead(collider, world.bodies, &live, is_skinned, dt);
                let at = Vec3::from(live.place.translation);
                let name = || name_of(entity);
                off = !advance(following, (ahead, at), (weights, &shared), (span, dt), bad_place, name);
                let drawn_at = rigid_place(&live.place.into());
                if !off
                    && collider.parent().is_none()
                    // A scale of zero leaves no valid rotation, and Rapier would disable the collider permanently.
                    && (!is_rigid(collider.position()) || (span.is_some() && *collider.position() != drawn_at))
                    && let Some(collider) = world.colliders.get_mut(handle.0)
                {
                    collider.set_position(drawn_at);
                }
            }
            surface.switch(off, collider_disabled, world.colliders, handle.0);
            let RapierSurface {
                following,
                pushing,
                told_open,
                ..
            } = surface;
            if off {
                pushing.stop(&mut world);
                continue;
            }
            let Some(collider) = world.colliders.get(handle.0) else {
                continue;
            };
            diagnostics.surfaces += u32::from(collider.is_enabled());
            diagnostics.moving += u32::from(collider.is_enabled() && following.moves);
            let parent = collider.parent();
            let on_dynamic = parent
                .and_then(|body| world.bodies.get(body))
                .is_some_and(RigidBody::is_dynamic);
            let is_there = collider.is_enabled() && !collider.is_sensor();
            let wanted = solver_groups.map_or(InteractionGroups::all(), |&groups| groups.into());
            let carrier = match parent.filter(|_| on_dynamic && is_there && following.moves) {
                Some(body) => Carrier::of(body, collider, &world, dt),
                None => None,
            };
            if carrier.is_some() && obstacles.is_none() {
                obstacles = Some(Obstacles::find(&world, dt, count));
            }
            let pushes_itself = !is_there || (on_dynamic && carrier.is_none());
            let own_groups = if pushes_itself { wanted } else { no_push(wanted) };
            let manners = Manners::of(collider, wanted);
            let sides = set_sides(following, (settings.solid, on_dynamic), told_open, || name_of(entity));
            let Sides { turned, is_closed } = sides;
            let changed = following.moves || following.reshaped || turned;
            if (changed || collider.solver_groups() != own_groups)
                && let Some(collider) = world.colliders.get_mut(handle.0)
            {
                collider.set_solver_groups(own_groups);
                if changed {
                    // The shape is the same object but has changed; setting it again makes Rapier recompute contacts and boxes.
                    let shape = collider.shared_shape().clone();
                    collider.set_shape(shape);
                }
            }
            let step = Step {
                pace: Pace {
                    dt,
                    prediction: parameters.prediction_distance() + manners.contact_skin,
                    max_acceleration: settings.max_acceleration,
                },
                // The speed at which Rapier separates overlapping bodies.
                leaving: parameters.max_corrective_velocity().min(10.0 * parameters.length_unit),
                movers,
                obstacles: obstacles.as_ref(),
                audience: &audience,
                body: parent,
                stepping: now,
            };
            if following.moves
                && on_dynamic
                && let Some(body) = parent
            {
                world.islands.wake_up(world.bodies, body, true);
            }
            if pushes_itself {
                pushing.stop_parts(&mut world);
            } else {
                let mut carrier = carrier;
                diagnostics.blended += pushing.prepare(following, manners, &step, carrier.as_mut(), &mut world);
                diagnostics.parts += pushing.parts();
                to_link.extend(carrier.into_iter().flat_map(|carrier| carrier.links));
            }
            if on_dynamic && is_closed && settings.solid && is_there {
                pushing.drive_apart(handle.0, following, &manners, &step, &mut world);
            } else if pushes_itself || on_dynamic {
                pushing.stop_driving();
            }
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
    let mut repeating = HashMap::default();
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
            pushing.finish(&following.surface, &mut bodies.bodies, &mut colliders.colliders);
        }
    }
    tell_whole(&repeating, &mut touches, |context| {
        let (simulation, _, colliders, _) = contexts.get(context).ok()?;
        Some((&simulation.narrow_phase, colliders))
    });
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
