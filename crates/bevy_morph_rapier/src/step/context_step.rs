//! A step of one physics world.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy::prelude::*;
use bevy_morph_physics::MorphPhysicsDiagnostics;
use bevy_morph_physics::engine::Sources;
use bevy_morph_physics::push::StepParams;
use bevy_morph_physics::shape::{MAX_COORDINATE, MassBudget};
use bevy_morph_physics::time::StepTime;
use bevy_rapier3d::rapier::dynamics::IntegrationParameters;
use tracing::error;

use super::input::SurfaceItem;
use super::stages::{Role, advance, expel, push, update_collider};
use crate::push::{ContactListeners, Link, Movers, Obstacles, Step, World};

/// A step of one physics world.
pub(super) struct ContextStep<'a> {
    /// The entity of the world.
    pub(super) context: Entity,
    pub(super) time: StepTime,
    pub(super) parameters: IntegrationParameters,
    pub(super) surface_count: usize,
    /// Whether Rapier does a single step, perhaps with substeps.
    pub(super) once: bool,
    pub(super) listeners: ContactListeners,
    /// Found when a surface needs them.
    pub(super) obstacles: Option<Obstacles>,
    pub(super) movers: &'a Movers,
    /// For the surfaces of all worlds.
    pub(super) masses: &'a mut MassBudget,
    /// Set while a step is in progress.
    pub(super) now: &'a Arc<AtomicBool>,
    /// The parts that become links of their body.
    pub(super) links: Vec<Link>,
}

impl ContextStep<'_> {
    /// Prepares a surface, one stage after another, if it is in this world.
    pub(super) fn prepare(
        &mut self,
        it: &mut SurfaceItem,
        sources: &mut Sources,
        world: &mut World,
        diagnostics: &mut MorphPhysicsDiagnostics,
    ) {
        let handle = it.handle.0;
        let state = &mut it.surface.state;
        // A surface that came from another world in this frame still has its parts there.
        let is_elsewhere = it.link.0 != self.context || state.context.is_some_and(|home| home != self.context);
        if is_elsewhere || !world.colliders.contains(handle) {
            return;
        }
        state.context = Some(self.context);
        let parameters = self.parameters;
        let name = || sources.name(it.entity);
        it.surface
            .set_max_acceleration(it.settings, parameters.length_unit, name);
        let off = it.is_morph_disabled || !advance(it, self.time, sources, world);
        let surface = &mut *it.surface;
        surface.state.switch(
            off,
            &mut surface.moving,
            it.is_collider_disabled,
            world.colliders,
            handle,
        );
        if off {
            surface.state.pushing.stop(world);
            return;
        }
        let Some(mut role) = Role::of(it, world, self.time.dt) else {
            return;
        };
        diagnostics.surfaces += u32::from(role.is_enabled);
        diagnostics.moving += u32::from(role.is_enabled && it.surface.moving.moves);
        let is_closed = update_collider(it, &role, sources, self.masses, world);
        if role.carrier.is_some() && self.obstacles.is_none() {
            self.obstacles = Some(Obstacles::find(world, self.time.dt, self.surface_count));
        }
        let step = Step {
            params: StepParams {
                dt: self.time.dt,
                prediction: parameters.prediction_distance() + role.material.contact_skin,
            },
            // The speed at which Rapier separates overlapping bodies.
            expel_speed: parameters.max_corrective_velocity().min(10.0 * parameters.length_unit),
            movers: self.movers,
            obstacles: self.obstacles.as_ref(),
            listeners: &self.listeners,
            once: self.once,
            body: role.body,
            stepping: self.now,
        };
        diagnostics.blended += push(it, &mut role, &step, world);
        diagnostics.awake += u32::from(it.surface.state.pushing.is_awake());
        diagnostics.parts += it.surface.state.pushing.parts();
        expel(it, is_closed && it.settings.solid, &role, &step, world);
        self.links
            .extend(role.carrier.into_iter().flat_map(|carrier| carrier.links));
    }
}

/// Logs that no surface pushes the collider with this user data.
pub(super) fn log_too_large(collider: u128, sources: &Sources) {
    let name = Entity::try_from_bits(collider as u64).map(|entity| sources.name(entity));
    let name = name.unwrap_or_default();
    error!(
        "the collider of entity `{name}` is more than {MAX_COORDINATE:e} units large, or moves that far in a step: no deforming surface \
         pushes it; make it smaller"
    );
}
