//! What a surface does before a step, one stage after another: it moves to its pose at the end of the step, takes its role in physics,
//! shows its shape to Avian, and pushes.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use avian3d::prelude::{Collider, RigidBody, WakeBody};
use bevy::ecs::entity::hash_map::EntityHashMap;
use bevy::prelude::*;
use bevy_morph_physics::engine::Sources;
use bevy_morph_physics::push::StepParams;
use bevy_morph_physics::shape::MassBudget;
use bevy_morph_physics::time::StepTime;
use parry3d::shape::SharedShape;

use super::predict::{Joints, Start, predict};
use super::query::{BodyItem, SurfaceItem, World};
use crate::isometry::{isometry, isometry_in_body};
use crate::push::{ContactMaterial, Movers, PartBodies, Surroundings};
use crate::whole_surface::WholeSurface;

/// Moves a surface to its pose at the end of the step. Returns whether it takes part in the step.
pub(super) fn advance(
    surface: &mut SurfaceItem,
    body: Option<&BodyItem>,
    time: StepTime,
    sources: &mut Sources,
) -> bool {
    if surface.is_morph_disabled {
        return false;
    }
    let moving = &mut surface.state.moving;
    let is_skinned = moving.is_skinned();
    // The collider reports bad joints. The last good ones are used.
    let skin = surface.drawn_with.skin.filter(|_| is_skinned);
    // Avian determines where the entity is.
    moving.drawn.stands_alone = false;
    moving.drawn.on_body = body.is_some();
    let live = sources.live(moving, surface.drawn_with.transform, skin);
    moving.drawn.at_step(&live);
    let middle = moving.drawn.middle();
    let between_frames = time.span.and_then(|span| moving.drawn.joints.at(span.end));
    let joints = match (live.joints, between_frames) {
        (Ok(Some(_)), Some(sample)) => Some(Joints::Between(sample)),
        _ => skin
            .and_then(|skin| sources.world_from_joints(skin))
            .map(|joints| Joints::Drawn(joints, middle)),
    };
    let collider = surface.position.zip(surface.rotation);
    let start = Start {
        entity: surface.drawn_with.transform,
        // An entity whose collider is still to come is at its own transform.
        collider: collider
            .filter(|_| surface.collider.is_some())
            .map(|(position, rotation)| isometry(position, rotation)),
        body,
        in_body: isometry_in_body(
            surface
                .in_body
                .filter(|_| body.is_some_and(|body| body.entity != surface.entity)),
        ),
        is_skinned,
        joints,
    };
    let prediction = predict(start, time.dt);
    let at = surface.drawn_with.transform.translation();
    let weights = sources.weights(surface.drawn_with.weights);
    let entity = surface.entity;
    surface
        .state
        .advance(prediction, at, &weights, time, || sources.name(entity))
}

/// Takes a surface out of physics. Movement until it is back does not count as motion.
pub(super) fn exclude(surface: &mut SurfaceItem, commands: &mut Commands) {
    if surface.collider.is_some() {
        commands.entity(surface.entity).try_remove::<Collider>();
    }
    stop(surface, commands);
}

/// Stops pushing with a surface that is switched off, but can be found by queries.
pub(super) fn stop(surface: &mut SurfaceItem, commands: &mut Commands) {
    surface.state.moving.restart();
    surface.state.state.pushing.stop(commands);
}

/// What a surface is in physics during a step.
pub(super) struct Role {
    body: Option<Entity>,
    on_dynamic: bool,
    /// Whether contacts are made with the whole surface, instead of parts.
    has_contacts: bool,
    /// Whether it pushes with parts.
    pushes: bool,
    material: ContactMaterial,
}

impl Role {
    pub(super) fn of(surface: &SurfaceItem, body: Option<&BodyItem>) -> Self {
        let on_dynamic = body.is_some_and(|body| *body.kind == RigidBody::Dynamic);
        let has_contacts = on_dynamic || surface.is_sensor;
        Self {
            body: body.map(|body| body.entity),
            on_dynamic,
            has_contacts,
            pushes: !has_contacts && body.is_none_or(|body| !body.is_disabled),
            material: ContactMaterial {
                friction: surface.friction.or(body.and_then(|body| body.friction)).copied(),
                restitution: surface.restitution.copied(),
                margin: surface.margin.or(body.and_then(|body| body.margin)).copied(),
                layers: surface.layers.copied().unwrap_or_default(),
                hooks: surface.hooks.copied(),
            },
        }
    }
}

/// Gives Avian the shape of a surface if it has changed, and notes that.
pub(super) fn update_collider(
    surface: &mut SurfaceItem,
    role: &Role,
    sources: &Sources,
    step: &mut StepInput,
    commands: &mut Commands,
) {
    let entity = surface.entity;
    let solid = surface.settings.solid;
    let sides = surface
        .state
        .set_sides(solid, role.on_dynamic, &mut step.masses, || sources.name(entity));
    let moving = &surface.state.moving;
    let shape = || {
        let whole = WholeSurface::new(moving.surface.clone(), role.has_contacts, step.now.clone());
        Collider::from(SharedShape::new(whole))
    };
    match &mut surface.collider {
        // The first step, or the first one after it was switched off.
        None => {
            commands.entity(entity).try_insert(shape());
        }
        Some(collider) => {
            if moving.reshaped || sides.turned || surface.state.state.has_contacts != role.has_contacts {
                **collider = shape();
                step.changed.push((entity, 0.0));
            }
        }
    }
    surface.state.state.has_contacts = role.has_contacts;
}

/// What surfaces share in a step.
pub(super) struct StepInput<'a> {
    pub(super) dt: f32,
    /// Whether contacts are being computed.
    pub(super) now: &'a Arc<AtomicBool>,
    pub(super) movers: &'a Movers,
    /// Colliders that change, and how far they reach in the step.
    pub(super) changed: &'a mut Vec<(Entity, f32)>,
    /// The velocity changes of bodies inside solid surfaces.
    pub(super) expelled: &'a mut EntityHashMap<Vec3>,
    pub(super) masses: MassBudget,
}

/// Puts the parts with which a surface pushes into the world. Returns how many had to be blended.
pub(super) fn push(surface: &mut SurfaceItem, role: &Role, step: &mut StepInput, world: &mut World) -> u32 {
    let surface_state = &mut *surface.state;
    let (moving, pushing) = (&mut surface_state.moving, &mut surface_state.state.pushing);
    if !role.pushes {
        if let (true, true, Some(body)) = (moving.moves, role.on_dynamic, role.body) {
            world.commands.queue_silenced(WakeBody(body));
        }
        pushing.stop(&mut world.commands);
        return 0;
    }
    let material = role.material;
    let length_unit = world.length_unit.0;
    let params = StepParams {
        dt: step.dt,
        prediction: length_unit * world.narrow_phase.contact_tolerance
            + material.margin.map_or(0.0, |margin| margin.0.max(0.0)),
    };
    let mut surroundings = Surroundings {
        movers: step.movers,
        body: role.body,
        listens: surface.wants_events || surface.wants_colliding,
        joints: &world.joints,
        sleep: &mut world.sleep,
        // The speed at which Avian separates overlapping bodies.
        expel_speed: world.solver.max_overlap_solve_speed.min(10.0) * length_unit,
        expelled: step.expelled,
    };
    let mut bodies = PartBodies {
        surface: surface.entity,
        material,
        stepping: step.now,
        commands: &mut world.commands,
        parts: &mut world.parts,
        changed: step.changed,
    };
    pushing.prepare(moving, &params, &mut surroundings, &mut bodies)
}
