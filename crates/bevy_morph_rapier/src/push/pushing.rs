//! How a surface pushes: with parts near moving bodies, as kinematic Rapier bodies.

use std::sync::Arc;

use bevy::math::Vec3;
use bevy::prelude::Entity;
use bevy_morph_physics::moving::MovingSurface;
use bevy_morph_physics::push::{Budget, Expelling, NearbyParts, Passage, middle};
use bevy_morph_physics::shape::{MeshLayout, MorphSurface};
use bevy_rapier3d::parry::bounding_volume::Aabb;
use bevy_rapier3d::parry::query::Ray;
use bevy_rapier3d::plugin::context::RapierContextSimulation;
use bevy_rapier3d::prelude::ContactForceEvent;
use bevy_rapier3d::rapier::dynamics::{RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle, ColliderSet};
use bevy_rapier3d::rapier::pipeline::QueryFilter;

use super::expel::drive_apart;
use super::filtered_bodies::FilteredBodies;
use super::forces::{Forces, SteppedWorld};
use super::material::ContactMaterial;
use super::part::PartHandles;
use super::step::Step;
use super::world::World;

/// The parts with which a surface pushes.
pub(crate) struct Pushing {
    pub(super) entity: Entity,
    pub(super) near: NearbyParts<ColliderHandle, RigidBodyHandle, PartHandles>,
    /// Whether its parts are links of a dynamic body.
    pub(super) linked: bool,
    pub(super) material: Option<ContactMaterial>,
    /// Whether parts have no name, so that Rapier does not report their contacts.
    pub(super) nameless: bool,
    /// Whether Rapier reports contacts of parts in addition to those of the whole surface.
    pub(crate) repeats: bool,
    forces: Forces,
    pub(super) filtered: FilteredBodies,
    /// The colliders near or inside the surface, if it is solid.
    pub(super) expelling: Expelling<ColliderHandle>,
    pub(super) passage: Passage<ColliderHandle, RigidBodyHandle>,
    /// Bodies whose CCD is switched on or off for this step only, with their usual setting.
    pub(super) bullets: Vec<(RigidBodyHandle, bool)>,
    /// Whether parts looked ahead in the last step.
    pub(super) looked_ahead: bool,
    // Scratch memory.
    pub(super) meeting: Vec<u32>,
    pub(super) fast: Vec<(Aabb, f32)>,
}

impl Pushing {
    pub(crate) fn new(entity: Entity, layout: Arc<MeshLayout>) -> Self {
        Self {
            entity,
            near: NearbyParts::new(layout),
            linked: false,
            material: None,
            nameless: false,
            repeats: false,
            forces: Forces::default(),
            filtered: FilteredBodies::default(),
            expelling: Expelling::default(),
            passage: Passage::default(),
            bullets: Vec::new(),
            looked_ahead: false,
            meeting: Vec::new(),
            fast: Vec::new(),
        }
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.near.is_idle()
    }

    /// Whether triangles near a collider matter in the step.
    pub(crate) fn is_awake(&self) -> bool {
        self.near.is_awake()
    }

    /// The number of parts in the physics world.
    pub(crate) fn parts(&self) -> u32 {
        self.near.parts().count() as u32
    }

    /// Removes all parts from the world and forgets what was near.
    pub(crate) fn stop(&mut self, world: &mut World) {
        self.expelling.stop();
        self.stop_parts(world);
    }

    /// Removes all parts from the world.
    pub(crate) fn stop_parts(&mut self, world: &mut World) {
        if !self.is_idle() {
            self.near.stop(|part| world.remove(part.body));
            self.material = None;
        }
    }

    /// Stops driving out bodies that are inside.
    pub(crate) fn stop_driving(&mut self) {
        self.expelling.stop();
    }

    /// Drives bodies out of a surface on a dynamic body.
    pub(crate) fn drive_apart(
        &mut self,
        collider: ColliderHandle,
        moving: &mut MovingSurface,
        material: &ContactMaterial,
        step: &Step,
        world: &mut World,
    ) {
        self.filtered.find(step.body, world);
        drive_apart(
            &mut self.expelling,
            collider,
            moving,
            material,
            &self.filtered,
            step,
            world,
        );
    }

    /// Reports the contact forces of the surface in the step, if Rapier did not report those of its parts.
    pub(crate) fn report_forces(&mut self, stepped: &SteppedWorld, report: &mut impl FnMut(ContactForceEvent)) {
        if self.nameless {
            let parts = self.near.parts().map(|part| part.collider);
            self.forces.report(self.entity, parts, stepped, report);
        }
    }

    /// After a step, moves bodies back that have passed through the surface.
    pub(crate) fn move_back(
        &mut self,
        moving: &mut MovingSurface,
        simulation: &RapierContextSimulation,
        bodies: &mut RigidBodySet,
        colliders: &mut ColliderSet,
        budget: &mut Budget,
    ) {
        let end = |collider: ColliderHandle| {
            let collider = colliders.get(collider)?;
            let body = bodies.get(collider.parent()?)?;
            let in_body = collider.position_wrt_parent().copied().unwrap_or_default();
            Some((*body.position() * in_body).transform_point(middle(collider.shape())?))
        };
        let surface = self.name();
        let is_blocked = |mover: ColliderHandle, from: Vec3, to: Vec3| {
            let Some(mover) = colliders.get(mover) else { return true };
            let is_other = |_: ColliderHandle, other: &Collider| !other.is_sensor() && other.user_data != surface;
            let filter = QueryFilter::exclude_dynamic();
            let filter = filter.groups(mover.collision_groups()).predicate(&is_other);
            let pipeline = simulation.broad_phase.as_query_pipeline(
                simulation.narrow_phase.query_dispatcher(),
                bodies,
                colliders,
                filter,
            );
            pipeline.cast_ray(&Ray::new(from, to - from), 1.0, true).is_some()
        };
        let shifts = self.passage.move_back(moving, budget, end, is_blocked);
        for (&body, &shift) in &shifts {
            if let Some(body) = bodies.get_mut(body).filter(|body| body.is_dynamic()) {
                let locked = body.locked_axes().bits();
                let free = Vec3::from_array([0, 1, 2].map(|axis| if locked >> axis & 1 == 0 { 1.0 } else { 0.0 }));
                body.set_translation(body.translation() + free * shift, false);
            }
        }
        if !shifts.is_empty() {
            bodies.propagate_modified_body_positions_to_colliders(colliders);
        }
    }

    /// Gives parts the name of their surface again.
    pub(crate) fn finish(&mut self, surface: &MorphSurface, bodies: &mut RigidBodySet, colliders: &mut ColliderSet) {
        surface.set_quiet(false);
        self.repeats = false;
        if std::mem::take(&mut self.nameless) {
            self.name_parts(self.name(), colliders);
        }
        for (body, is_bullet) in self.bullets.drain(..) {
            if let Some(body) = bodies.get_mut(body) {
                body.enable_ccd(is_bullet);
            }
        }
    }

    fn name(&self) -> u128 {
        u128::from(self.entity.to_bits())
    }

    pub(super) fn name_parts(&self, name: u128, colliders: &mut ColliderSet) {
        for part in self.near.parts() {
            if let Some(collider) = colliders.get_mut(part.collider) {
                collider.user_data = name;
            }
        }
    }
}
