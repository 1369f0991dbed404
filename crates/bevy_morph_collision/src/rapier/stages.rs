//! What a surface does before a step, one stage after another: it follows its mesh, takes its role in physics, shows itself to
//! Rapier, and pushes.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_rapier3d::prelude::SolverGroups;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle, InteractionGroups};
use tracing::error;

use super::MorphRapierCollider;
use super::ahead::ahead;
use super::attach::RapierSurface;
use super::link::Carrier;
use super::world::{Manners, Step, World, no_push};
use crate::physics::ahead::{is_rigid, rigid_place};
use crate::physics::begin::{advance, set_sides};
use crate::physics::clock::StepTime;
use crate::physics::follow::Following;
use crate::physics::range::MAX_COORDINATE;
use crate::physics::sources::Sources;

/// Logs that no surface pushes the collider with this user data.
pub(super) fn tell_too_large(collider: u128, sources: &Sources) {
    let name = Entity::try_from_bits(collider as u64).map(|entity| sources.name(entity));
    let name = name.unwrap_or_default();
    error!(
        "the collider of entity `{name}` is more than {MAX_COORDINATE:e} units large, or moves that far in a step: no deforming surface \
         pushes it; make it smaller"
    );
}

/// Moves a surface to its pose at the end of the step. Returns whether it has a valid one.
pub(super) fn follow(
    surface: &mut RapierSurface,
    (entity, handle): (Entity, ColliderHandle),
    (place, weights, skin): (&GlobalTransform, Option<&MeshMorphWeights>, Option<&SkinnedMesh>),
    time: StepTime,
    sources: &mut Sources,
    world: &mut World,
) -> bool {
    let Some(collider) = world.colliders.get(handle) else {
        return false;
    };
    let RapierSurface {
        following, bad_place, ..
    } = surface;
    let is_skinned = following.is_skinned();
    following.drawn.stands_alone = collider.parent().is_none();
    following.drawn.on_body = collider.parent().is_some();
    let mut live = sources.live(following, place, skin);
    following.drawn.at_step(&live);
    if let Some(span) = time.span {
        live = following.drawn.at(span.end, live);
    }
    let ahead = ahead(collider, world.bodies, &live, is_skinned, time.dt);
    let at = Vec3::from(live.place.translation);
    let weights = (weights, &sources.shared);
    let name = || sources.name(entity);
    if !advance(following, (ahead, at), weights, time, bad_place, name) {
        return false;
    }
    let drawn_at = rigid_place(&live.place.into());
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
pub(super) struct Role {
    pub(super) manners: Manners,
    pub(super) body: Option<RigidBodyHandle>,
    pub(super) is_enabled: bool,
    /// Whether it can push.
    is_there: bool,
    on_dynamic: bool,
    /// Whether its own collider pushes, instead of parts.
    pushes_itself: bool,
    /// If its parts become links of its body.
    pub(super) carrier: Option<Carrier>,
    wanted: InteractionGroups,
}

impl Role {
    /// `None` without a collider.
    pub(super) fn of(
        following: &Following,
        handle: ColliderHandle,
        solver_groups: Option<&SolverGroups>,
        world: &World,
        dt: f32,
    ) -> Option<Self> {
        let collider = world.colliders.get(handle)?;
        let body = collider.parent();
        let on_dynamic = body
            .and_then(|body| world.bodies.get(body))
            .is_some_and(RigidBody::is_dynamic);
        let is_there = collider.is_enabled() && !collider.is_sensor();
        let wanted = solver_groups.map_or(InteractionGroups::all(), |&groups| groups.into());
        let carrier = match body.filter(|_| on_dynamic && is_there && following.moves) {
            Some(body) => Carrier::of(body, collider, world, dt),
            None => None,
        };
        Some(Self {
            manners: Manners::of(collider, wanted),
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
pub(super) fn show(
    surface: &mut RapierSurface,
    (entity, handle): (Entity, ColliderHandle),
    settings: &MorphRapierCollider,
    role: &Role,
    sources: &Sources,
    world: &mut World,
) -> bool {
    let RapierSurface {
        following, told_open, ..
    } = surface;
    let sides = set_sides(following, (settings.solid, role.on_dynamic), told_open, || {
        sources.name(entity)
    });
    let own_groups = if role.pushes_itself {
        role.wanted
    } else {
        no_push(role.wanted)
    };
    let changed = following.moves || following.reshaped || sides.turned;
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
pub(super) fn push(surface: &mut RapierSurface, role: &mut Role, step: &Step, world: &mut World) -> u32 {
    let RapierSurface { following, pushing, .. } = surface;
    if role.pushes_itself {
        pushing.stop_parts(world);
        return 0;
    }
    pushing.prepare(following, role.manners, step, role.carrier.as_mut(), world)
}

/// Drives bodies out of a solid surface on a dynamic body. Other surfaces do so while they push.
pub(super) fn drive(
    surface: &mut RapierSurface,
    handle: ColliderHandle,
    is_solid: bool,
    role: &Role,
    step: &Step,
    world: &mut World,
) {
    let RapierSurface { following, pushing, .. } = surface;
    if role.on_dynamic && is_solid && role.is_there {
        pushing.drive_apart(handle, following, &role.manners, step, world);
    } else if role.pushes_itself || role.on_dynamic {
        pushing.stop_driving();
    }
}
