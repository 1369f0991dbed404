//! What a surface does before a step, one stage after another: it moves to its pose at the end of the step, takes its role in physics,
//! shows itself to Rapier, and pushes.

use bevy::prelude::*;
use bevy_morph_physics::engine::Sources;
use bevy_morph_physics::math::{is_rigid, rigid_part};
use bevy_morph_physics::shape::MassBudget;
use bevy_morph_physics::time::StepTime;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::{Collider, InteractionGroups};

use super::input::SurfaceItem;
use super::predict::predict;
use crate::push::{Carrier, ContactMaterial, Step, World, no_push};
use crate::surface::RapierSurface;

/// Moves a surface to its pose at the end of the step. Returns whether it takes part in the step.
pub(super) fn advance(it: &mut SurfaceItem, time: StepTime, sources: &mut Sources, world: &mut World) -> bool {
    let handle = it.handle.0;
    let Some(collider) = world.colliders.get(handle) else {
        return false;
    };
    let moving = &mut it.surface.moving;
    let is_skinned = moving.is_skinned();
    moving.drawn.stands_alone = collider.parent().is_none();
    moving.drawn.on_body = collider.parent().is_some();
    let mut live = sources.live(moving, it.drawn_with.transform, it.drawn_with.skin);
    moving.drawn.at_step(&live);
    if let Some(span) = time.span {
        live = moving.drawn.at(span.end, live);
    }
    let prediction = predict(collider, world.bodies, &live, is_skinned, time.dt);
    let at = Vec3::from(live.transform.translation);
    let weights = sources.weights(it.drawn_with.weights);
    let name = || sources.name(it.entity);
    if !it.surface.advance(prediction, at, &weights, time, name) {
        return false;
    }
    let drawn_at = rigid_part(&live.transform.into());
    if collider.parent().is_none()
        // A scale of zero leaves no valid rotation, and Rapier would disable the collider permanently.
        && (!is_rigid(collider.position()) || (time.span.is_some() && *collider.position() != drawn_at))
        && let Some(collider) = world.colliders.get_mut(handle)
    {
        collider.set_position(drawn_at);
    }
    true
}

/// What a surface is in physics during a step.
pub(crate) struct Role {
    pub(crate) material: ContactMaterial,
    pub(crate) body: Option<RigidBodyHandle>,
    pub(crate) is_enabled: bool,
    /// Whether it can push.
    is_there: bool,
    on_dynamic: bool,
    /// Whether its own collider pushes, instead of parts.
    pushes_itself: bool,
    /// If its parts become links of its body.
    pub(crate) carrier: Option<Carrier>,
    wanted: InteractionGroups,
}

impl Role {
    /// `None` without a collider.
    pub(super) fn of(it: &SurfaceItem, world: &World, dt: f32) -> Option<Self> {
        let collider = world.colliders.get(it.handle.0)?;
        let body = collider.parent();
        let on_dynamic = body
            .and_then(|body| world.bodies.get(body))
            .is_some_and(RigidBody::is_dynamic);
        let is_there = collider.is_enabled() && !collider.is_sensor();
        let wanted = it
            .solver_groups
            .map_or(InteractionGroups::all(), |&groups| groups.into());
        let carrier = match body.filter(|_| on_dynamic && is_there && it.surface.moving.moves) {
            Some(body) => Carrier::of(body, collider, world, dt),
            None => None,
        };
        Some(Self {
            material: ContactMaterial::of(collider, wanted),
            body,
            is_enabled: collider.is_enabled(),
            is_there,
            on_dynamic,
            pushes_itself: !is_there || (on_dynamic && carrier.is_none()),
            carrier,
            wanted,
        })
    }
}

/// Tells Rapier what has changed about a surface. Returns whether its mesh is closed.
pub(super) fn update_collider(
    it: &mut SurfaceItem,
    role: &Role,
    sources: &Sources,
    masses: &mut MassBudget,
    world: &mut World,
) -> bool {
    let (entity, handle) = (it.entity, it.handle.0);
    let sides = it
        .surface
        .set_sides(it.settings.solid, role.on_dynamic, masses, || sources.name(entity));
    let moving = &it.surface.moving;
    let own_groups = if role.pushes_itself {
        role.wanted
    } else {
        no_push(role.wanted)
    };
    let changed = moving.moves || moving.reshaped || sides.turned;
    let differs = |collider: &Collider| collider.solver_groups() != own_groups;
    if (changed || world.colliders.get(handle).is_some_and(differs))
        && let Some(collider) = world.colliders.get_mut(handle)
    {
        collider.set_solver_groups(own_groups);
        if changed {
            // The shape is the same object but has changed; setting it again makes Rapier recompute contacts and boxes.
            let shape = collider.shared_shape().clone();
            collider.set_shape(shape);
        }
    }
    // It may have fallen asleep before it had a surface.
    if changed
        && role.on_dynamic
        && let Some(body) = role.body
    {
        world.islands.wake_up(world.bodies, body, true);
    }
    sides.is_closed
}

/// Puts the parts with which a surface pushes into the world. Returns how many had to be blended.
pub(super) fn push(it: &mut SurfaceItem, role: &mut Role, step: &Step, world: &mut World) -> u32 {
    let RapierSurface { moving, state, .. } = &mut *it.surface;
    if role.pushes_itself {
        state.pushing.stop_parts(world);
        return 0;
    }
    state
        .pushing
        .prepare(moving, role.material, step, role.carrier.as_mut(), world)
}

/// Drives bodies out of a solid surface on a dynamic body. Other surfaces do so while they push.
pub(super) fn expel(it: &mut SurfaceItem, is_solid: bool, role: &Role, step: &Step, world: &mut World) {
    let RapierSurface { moving, state, .. } = &mut *it.surface;
    if role.on_dynamic && is_solid && role.is_there {
        state
            .pushing
            .drive_apart(it.handle.0, moving, &role.material, step, world);
    } else if role.pushes_itself || role.on_dynamic {
        state.pushing.stop_driving();
    }
}
