//! Before each of Rapier's steps surfaces go where they will be at its end, and after it they are theirs who ask.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextEntityLink, RapierContextJoints, RapierContextSimulation, RapierRigidBodySet,
    SimulationToRenderTime,
};
use bevy_rapier3d::plugin::{RapierConfiguration, TimestepMode};
use bevy_rapier3d::prelude::{Collider, RapierColliderHandle, SolverGroups};
use bevy_rapier3d::rapier::dynamics::RigidBody;
use bevy_rapier3d::rapier::geometry::InteractionGroups;
use morph_collision::MorphBvh;
use tracing::error;

use super::MorphRapierCollider;
use super::follow::{Following, places};
use super::layout::MeshLayouts;
use super::push::Pushing;
use super::world::{Audience, Manners, Mover, Step, World, find_movers, no_push};
use crate::collider::ColliderState;

/// What the plugin knows of one surface.
#[derive(Component)]
pub(crate) struct RapierSurface {
    following: Following,
    pushing: Pushing,
    bvh: Arc<MorphBvh>,
    /// The physics world it is in.
    context: Option<Entity>,
}

/// What the last step of physics needed of [`MorphRapierCollider`]s.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphRapierDiagnostics {
    /// Colliders in physics.
    pub surfaces: u32,
    /// Of these, those that moved or morphed.
    pub moving: u32,
    /// Parts of surfaces near dynamic bodies: what is in the physics world as kinematic bodies.
    pub parts: u32,
    /// Of these, those whose vertices were blended for the step.
    pub blended: u32,
    /// Time taken before and after the step.
    pub duration: Duration,
}

/// What is true of all surfaces.
#[derive(Resource, Default)]
pub(crate) struct Stepping {
    /// Whether a step is going on.
    now: Arc<AtomicBool>,
    movers: Vec<Mover>,
}

/// Colliders whose tree is ready, or another one, get a surface.
pub(super) fn attach_surfaces(
    mut commands: Commands,
    colliders: Query<
        (
            Entity,
            &ColliderState,
            Option<&RapierSurface>,
            Option<&RapierContextEntityLink>,
        ),
        With<MorphRapierCollider>,
    >,
    mut layouts: ResMut<MeshLayouts>,
) {
    for (entity, state, surface, context) in &colliders {
        let Some(pose) = &state.pose else { continue };
        if let Some(surface) = surface {
            let elsewhere = surface.context.is_some() && surface.context != context.map(|link| link.0);
            if elsewhere || !Arc::ptr_eq(&surface.bvh, pose.bvh()) {
                // With its parts; the new one comes next time.
                commands.entity(entity).try_remove::<RapierSurface>();
            }
            continue;
        }
        let bvh = pose.bvh().clone();
        let layout = layouts.of(&bvh);
        let following = Following::new(&bvh, pose.weights(), &layout);
        let shape = SharedShape::new(following.surface.clone());
        let surface = RapierSurface {
            following,
            pushing: Pushing::new(entity, layout),
            bvh,
            context: None,
        };
        commands.entity(entity).try_insert((Collider::from(shape), surface));
    }
}

/// A collider that is no longer one leaves physics, parts and all.
pub(super) fn detach_surface(removed: On<Remove<MorphRapierCollider>>, mut commands: Commands) {
    commands
        .entity(removed.entity)
        .try_remove::<(Collider, RapierSurface)>();
}

type Contexts<'w, 's> = Query<
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

/// A surface that is being removed takes its parts along.
pub(super) fn take_parts_along(
    removed: On<Remove<RapierSurface>>,
    mut surfaces: Query<&mut RapierSurface, Allow<Disabled>>,
    mut contexts: Contexts,
) {
    let Ok(mut surface) = surfaces.get_mut(removed.entity) else {
        return;
    };
    let Some(context) = surface.context else { return };
    if let Ok((_, mut simulation, mut colliders, mut joints, mut bodies, ..)) = contexts.get_mut(context) {
        let RapierSurface { following, pushing, .. } = &mut *surface;
        pushing.finish(&following.surface, &mut bodies.bodies, &mut colliders.colliders);
        pushing.stop(&mut world(&mut simulation, &mut colliders, &mut joints, &mut bodies));
    }
}

fn world<'a>(
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

/// Surfaces that are disabled, or no colliders of Rapier's any more, push nothing.
pub(super) fn stop_absent(
    mut surfaces: Query<
        &mut RapierSurface,
        (
            Allow<Disabled>,
            Or<(With<Disabled>, Without<RapierColliderHandle>, Without<Collider>)>,
        ),
    >,
    mut contexts: Contexts,
) {
    for mut surface in &mut surfaces {
        let Some(context) = surface.context.filter(|_| !surface.pushing.is_idle()) else {
            continue;
        };
        if let Ok((_, mut simulation, mut colliders, mut joints, mut bodies, ..)) = contexts.get_mut(context) {
            let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
            surface.pushing.stop(&mut world);
        }
    }
}

/// Surfaces go where they will be at the end of the step, and bodies near them get something to stand on.
pub(super) fn before_step(
    mut contexts: Contexts,
    mut surfaces: Query<(
        Entity,
        &MorphRapierCollider,
        &mut RapierSurface,
        &RapierColliderHandle,
        &RapierContextEntityLink,
        &GlobalTransform,
        Option<&MeshMorphWeights>,
        Option<&SolverGroups>,
    )>,
    shared: Query<&MorphWeights>,
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
    let Stepping { now, movers } = &mut *stepping;
    for (context, mut simulation, mut colliders, mut joints, mut bodies, configuration, behind) in &mut contexts {
        let dt = time_ahead(&mode, &time, behind.diff);
        if !configuration.physics_pipeline_active || dt <= 0.0 {
            continue;
        }
        now.store(true, Ordering::Release);
        let parameters = simulation.integration_parameters;
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        find_movers(world.bodies, world.colliders, dt, movers);
        let audience = Audience::of(&world);
        for (entity, settings, mut surface, handle, link, place, weights, solver_groups) in &mut surfaces {
            if link.0 != context {
                continue;
            }
            let RapierSurface {
                following,
                pushing,
                context: at_home,
                ..
            } = &mut *surface;
            let Some(collider) = world.colliders.get(handle.0) else {
                continue;
            };
            if at_home.is_some_and(|home| home != context) {
                // It came from another world in this frame; its parts are still there.
                continue;
            }
            *at_home = Some(context);
            diagnostics.surfaces += 1;
            let places = places(collider, world.bodies, place, dt);
            if let Err(complaint) = following.advance(weights, &shared, places, dt) {
                let name = names.get(entity).map(|name| name.to_string()).unwrap_or_default();
                error!("the surface of entity `{name}` stays as it was: {complaint}");
            }
            diagnostics.moving += u32::from(following.moves);
            let parent = collider.parent();
            let on_dynamic = parent
                .and_then(|body| world.bodies.get(body))
                .is_some_and(RigidBody::is_dynamic);
            let wanted = solver_groups.map_or(InteractionGroups::all(), |&groups| groups.into());
            let pushes_itself = on_dynamic || collider.is_sensor() || !collider.is_enabled();
            let own_groups = if pushes_itself { wanted } else { no_push(wanted) };
            let manners = Manners::of(collider, wanted);
            following.surface.lock().set_solid(on_dynamic);
            let changed = following.moves || following.reshaped;
            if (changed || collider.solver_groups() != own_groups)
                && let Some(collider) = world.colliders.get_mut(handle.0)
            {
                collider.set_solver_groups(own_groups);
                if changed {
                    // The same shape, changed: contacts and boxes are computed anew.
                    let shape = collider.shared_shape().clone();
                    collider.set_shape(shape);
                }
            }
            if pushes_itself {
                if following.moves
                    && on_dynamic
                    && let Some(body) = parent
                {
                    world.islands.wake_up(world.bodies, body, true);
                }
                if !pushing.is_idle() {
                    pushing.stop(&mut world);
                }
                continue;
            }
            let step = Step {
                dt,
                movers,
                prediction: parameters.prediction_distance() + manners.contact_skin,
                max_acceleration: settings.max_acceleration,
                audience,
                stepping: now,
            };
            diagnostics.blended += pushing.prepare(following, manners, &step, &mut world);
            diagnostics.parts += pushing.parts();
        }
    }
    diagnostics.duration = start.elapsed();
}

/// Parts are there for steps alone.
pub(super) fn after_step(
    mut contexts: Query<(&mut RapierRigidBodySet, &mut RapierContextColliders)>,
    mut surfaces: Query<&mut RapierSurface, Allow<Disabled>>,
    stepping: Res<Stepping>,
    mut diagnostics: ResMut<MorphRapierDiagnostics>,
) {
    let start = Instant::now();
    stepping.now.store(false, Ordering::Release);
    for mut surface in &mut surfaces {
        let surface = &mut *surface;
        if let Some((mut bodies, mut colliders)) = surface.context.and_then(|context| contexts.get_mut(context).ok()) {
            let RapierSurface { following, pushing, .. } = surface;
            pushing.finish(&following.surface, &mut bodies.bodies, &mut colliders.colliders);
        }
    }
    diagnostics.duration += start.elapsed();
}

/// How much time Rapier will go on by.
fn time_ahead(mode: &TimestepMode, time: &Time, behind: f32) -> f32 {
    match *mode {
        TimestepMode::Fixed { dt, substeps } if substeps > 0 => dt,
        TimestepMode::Variable {
            max_dt,
            time_scale,
            substeps,
        } if substeps > 0 => (time.delta_secs() * time_scale).min(max_dt),
        TimestepMode::Interpolated {
            dt,
            time_scale,
            substeps,
        } if substeps > 0 && dt > 0.0 => {
            let (mut left, mut steps) = (behind + time.delta_secs(), 0.0);
            while left > 0.0 {
                left -= dt;
                steps += 1.0;
            }
            steps * dt * time_scale
        }
        _ => 0.0,
    }
}

/// Every context gets to know surfaces as it comes into the world, before it has contacts, and before a game gives it something else.
pub(super) fn teach_context(
    added: On<Add<RapierContextSimulation>>,
    mut contexts: Query<&mut RapierContextSimulation>,
) {
    if let Ok(mut context) = contexts.get_mut(added.entity) {
        context.set_query_dispatcher(super::MorphQueryDispatcher);
    }
}
