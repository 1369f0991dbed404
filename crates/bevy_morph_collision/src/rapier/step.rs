//! Moves surfaces to their pose at the end of Rapier's step, and releases them to queries afterwards.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashSet;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextEntityLink, RapierContextJoints, RapierContextSimulation, RapierRigidBodySet,
    SimulationToRenderTime,
};
use bevy_rapier3d::plugin::{RapierConfiguration, TimestepMode};
use bevy_rapier3d::prelude::{ColliderDisabled, RapierColliderHandle, SolverGroups};
use bevy_rapier3d::rapier::dynamics::RigidBody;
use bevy_rapier3d::rapier::geometry::InteractionGroups;
use tracing::error;

use super::MorphRapierCollider;
use super::attach::RapierSurface;
use super::follow::{Ahead, is_rigid, rigid_place};
use super::range::{MAX_COORDINATE, box_in_range, in_range};
use super::world::{Audience, Manners, Mover, Step, World, find_movers, no_push};
use crate::collider::MorphColliderDisabled;
use crate::skeletons::{BindPoses, Skeletons};

/// What the last step of physics needed of [`MorphRapierCollider`]s.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphRapierDiagnostics {
    /// Surfaces in physics, without those that are switched off, too large, or at a place that is not finite.
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
    /// The colliders of bodies that were too large in the last step: these are in the log.
    too_large: HashSet<u128>,
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
        (Option<&MeshMorphWeights>, Option<&SkinnedMesh>),
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
    let global_of = |joint: Entity| Some(globals.get(joint).ok()?.affine());
    let Stepping { now, movers, too_large } = &mut *stepping;
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
        let dt = time_ahead(&mode, &time, behind.diff);
        if !configuration.physics_pipeline_active || dt <= 0.0 {
            continue;
        }
        now.store(true, Ordering::Release);
        if !has_stepped {
            // Not in frames without a step, or skeletons would be forgotten in a pause.
            skeletons.begin();
        }
        has_stepped = true;
        let parameters = simulation.integration_parameters;
        let mut world = world(&mut simulation, &mut colliders, &mut joints, &mut bodies);
        find_movers(world.bodies, world.colliders, dt, movers, &mut refuse);
        let audience = Audience::of(&world);
        for (entity, settings, mut surface, handle, link, place, shows, solver_groups, disabled) in &mut surfaces {
            if link.0 != context {
                continue;
            }
            let surface = &mut *surface;
            let Some(collider) = world.colliders.get(handle.0) else {
                continue;
            };
            if surface.context.is_some_and(|home| home != context) {
                // It came from another world in this frame; its parts are still there.
                continue;
            }
            surface.context = Some(context);
            let (morph_disabled, collider_disabled) = disabled;
            let mut off = morph_disabled;
            if !morph_disabled {
                let (weights, skin) = shows;
                let is_skinned = surface.following.is_skinned();
                // Bad joints are the collider's to report. The last good ones stay in force.
                let joints = skin.filter(|_| is_skinned).and_then(|skin| {
                    let skeleton = skeletons.of(skin, bind_poses.as_deref(), global_of);
                    skeleton.world_from_mesh()
                });
                let ahead = Ahead::of(collider, world.bodies, place, (is_skinned, joints), dt);
                let bad_place = match ahead {
                    Ok(ahead) => {
                        if let Err(complaint) = surface.following.advance(weights, &shared, ahead, dt) {
                            let name = name_of(entity);
                            error!("the surface of entity `{name}` stays as it was: {complaint}");
                        }
                        let bounds = surface.following.surface.lock().bounds();
                        let fits = box_in_range(&bounds) && in_range(place.translation());
                        (!fits).then(|| format!("it is larger than {MAX_COORDINATE:e} units or as far from the origin"))
                    }
                    Err(error) => Some(error.to_string()),
                };
                off = bad_place.is_some() || surface.following.lacks_joints();
                if let Some(bad_place) = &bad_place
                    && surface.bad_place.as_ref() != Some(bad_place)
                {
                    let name = name_of(entity);
                    error!(
                        "the surface of entity `{name}` is left out of physics until its transform is good again: {bad_place}"
                    );
                }
                surface.bad_place = bad_place;
                if !off
                    && collider.parent().is_none()
                    && !is_rigid(collider.position())
                    && let Some(collider) = world.colliders.get_mut(handle.0)
                {
                    // A scale of zero leaves no valid rotation, and Rapier would disable the collider for good.
                    collider.set_position(rigid_place(place));
                }
            }
            surface.switch(off, collider_disabled, world.colliders, handle.0);
            let RapierSurface { following, pushing, .. } = surface;
            if off {
                if !pushing.is_idle() {
                    pushing.stop(&mut world);
                }
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
    if has_stepped {
        *too_large = refused;
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
