//! How a surface pushes: with parts near moving bodies, as kinematic Rapier bodies.

use std::sync::Arc;

use bevy::math::Vec3;
use bevy::prelude::Entity;
use bevy_morph_physics::moving::MovingSurface;
use bevy_morph_physics::push::{Budget, Expelling, NearbyParts, Passage, middle};
use bevy_morph_physics::shape::{MeshLayout, MorphSurface, Patch};
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::query::Ray;
use bevy_rapier3d::parry::shape::Shape;
use bevy_rapier3d::plugin::context::RapierContextSimulation;
use bevy_rapier3d::prelude::ContactForceEvent;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle, ColliderSet};
use bevy_rapier3d::rapier::pipeline::{ActiveEvents, QueryFilter};

use super::expel::{drive_apart, drive_out};
use super::filtered_bodies::FilteredBodies;
use super::forces::{Forces, SteppedWorld};
use super::link::Carrier;
use super::material::ContactMaterial;
use super::movers::Mover;
use super::part::{PartBodies, PartHandles};
use super::world::{Step, World};

/// The parts with which a surface pushes.
pub(crate) struct Pushing {
    entity: Entity,
    near: NearbyParts<ColliderHandle, RigidBodyHandle, PartHandles>,
    /// Whether its parts are links of a dynamic body.
    linked: bool,
    material: Option<ContactMaterial>,
    /// Whether parts have no name, so that Rapier does not report their contacts.
    nameless: bool,
    /// Whether Rapier reports contacts of parts in addition to those of the whole surface.
    pub(crate) repeats: bool,
    forces: Forces,
    filtered: FilteredBodies,
    /// The colliders near or inside the surface, if it is solid.
    expelling: Expelling<ColliderHandle>,
    passage: Passage<ColliderHandle, RigidBodyHandle>,
    /// Bodies whose CCD is switched on or off for this step only, with their usual setting.
    bullets: Vec<(RigidBodyHandle, bool)>,
    /// Whether parts looked ahead in the last step.
    looked_ahead: bool,
    // Scratch memory.
    meeting: Vec<u32>,
    fast: Vec<(Aabb, f32)>,
}

/// How a surface pushes one mover.
struct Push<'a, 'b> {
    material: ContactMaterial,
    step: &'a Step<'b>,
    is_solid: bool,
    /// Whether all parts stay as they are.
    stays: bool,
    /// Whether there are triangles near it.
    touches: bool,
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

    /// Prepares the coming step: everything that may touch the surface will touch parts that move like it.
    ///
    /// With a `carrier`, there are parts for everything that the surface may touch, fixed or not. The caller must join these
    /// parts to the carrier before the step.
    ///
    /// Returns how many parts had to be blended.
    pub(crate) fn prepare(
        &mut self,
        moving: &mut MovingSurface,
        material: ContactMaterial,
        step: &Step,
        mut carrier: Option<&mut Carrier>,
        world: &mut World,
    ) -> u32 {
        if self.linked != carrier.is_some() {
            self.stop(world);
            self.linked = carrier.is_some();
        }
        if step.movers.is_empty() && self.is_idle() && !self.linked {
            return 0;
        }
        self.near.begin(moving);
        self.passage.begin();
        let is_solid = moving.surface.lock().is_solid() && !self.linked;
        if !self.linked {
            self.expelling.begin(None);
        }
        let reach = step.params.prediction + carrier.as_ref().map_or(0.0, |carrier| carrier.way);
        let bounds = moving.bounds();
        let bounds = Aabb::new(bounds.min, bounds.max).loosened(reach);
        self.update_material(material, world.colliders);
        self.filtered.find(step.body, world);
        let obstacles = step.obstacles.filter(|_| self.linked);
        let obstacles = obstacles.map_or_else(Vec::new, |all| all.within(&bounds, step.params.dt, world));

        let (mut blended, mut searching) = (0, Vec::new());
        let mut events = material.events;
        let mut meeting = std::mem::take(&mut self.meeting);
        for mover in step.movers.meeting(&bounds, &mut meeting).chain(&obstacles) {
            let nearby = &mover.nearby;
            if carrier.as_ref().is_some_and(|carrier| carrier.has(mover)) {
                continue;
            }
            if !mover.groups.test(material.groups) || self.filtered.contains(nearby.body) {
                continue;
            }
            events |= mover.events;
            if self.near.sleeps_on(nearby, moving) {
                self.expelling.keep(nearby.collider);
                continue;
            }
            let touches = if self.linked {
                self.near.search_anew(nearby, moving, reach)
            } else {
                self.near.search(nearby, moving, &step.params)
            };
            searching.push((mover, touches));
        }
        let busy = !searching.is_empty();
        let stays = self.near.stays(moving);
        if busy && !stays {
            let is_asleep = |body| world.bodies.get(body).is_some_and(RigidBody::is_sleeping);
            self.near.reserve_triangles(moving, is_asleep);
        }
        for (mover, touches) in searching {
            let push = Push {
                material,
                step,
                is_solid,
                stays,
                touches,
            };
            blended += self.push_against(mover, &push, moving, carrier.as_deref_mut(), world);
        }
        self.meeting = meeting;
        self.near.forget(|part| world.remove(part.body));
        self.set_look_ahead(world);
        if let Some(carrier) = carrier {
            self.leave_out_unlinked(carrier, world.colliders);
        } else {
            self.expelling.forget();
        }
        for body in self.near.take_to_wake() {
            world.islands.wake_up(world.bodies, body, true);
        }
        self.choose_names(events, step, busy, &bounds, moving, world.colliders);
        self.filtered
            .disable_contacts(self.near.parts().map(|part| part.body), world);
        blended
    }

    /// Decides whether parts have the name of their surface in the step, so that Rapier reports their contacts.
    fn choose_names(
        &mut self,
        events: ActiveEvents,
        step: &Step,
        busy: bool,
        bounds: &Aabb,
        moving: &MovingSurface,
        colliders: &mut ColliderSet,
    ) {
        let listening = step.listeners.listens || events.contains(ActiveEvents::COLLISION_EVENTS);
        moving.surface.set_quiet(!listening);
        if busy && (listening || events.contains(ActiveEvents::CONTACT_FORCE_EVENTS)) {
            // The surface reports its contacts as a whole, and parts without a name report nothing. Hooks receive the names of
            // colliders, so they need named parts.
            let hooked = step.listeners.hooks_near(&bounds.loosened(moving.displacement as f32));
            self.repeats = listening && hooked;
            self.nameless = !hooked;
            if self.nameless {
                self.name_parts(0, colliders);
            }
        }
    }

    /// Pushes one mover, or an obstacle. Returns how many parts had to be blended.
    fn push_against(
        &mut self,
        mover: &Mover,
        push: &Push,
        moving: &mut MovingSurface,
        carrier: Option<&mut Carrier>,
        world: &mut World,
    ) -> u32 {
        let mut blended = 0;
        let nearby = &mover.nearby;
        let is_inside =
            push.is_solid && drive_out(&mut self.expelling, mover, moving, &push.material, push.step, world);
        if push.touches && mover.look_ahead > 0.0 {
            self.fast.push((nearby.bounds, mover.look_ahead));
        }
        // Rapier sweeps fast bodies against fixed ones, but against kinematic ones, such as parts, only if they are bullets.
        // A body on its way out must not be a bullet, because the surface would stop it.
        if push.touches
            && (mover.fast || is_inside)
            && let Some(body) = world.bodies.get_mut(nearby.body)
            && body.is_ccd_enabled() == is_inside
        {
            body.enable_ccd(!is_inside);
            self.bullets.push((nearby.body, mover.bullet));
        }
        if !push.stays {
            let mut bodies = PartBodies {
                entity: self.entity,
                material: push.material,
                stepping: push.step.stepping,
                carrier,
                world: &mut *world,
            };
            blended = self.near.push(nearby, moving, &push.step.params, &mut bodies);
        }
        // After several steps, nobody knows which way a body went.
        if push.step.once
            && !self.linked
            && !push.material.is_hooked()
            && let Some(flight) = &mover.flight
            && let Some(collider) = world.colliders.get(nearby.collider)
            // Whether the solver pushes it away from the surface.
            && collider.solver_groups().test(push.material.solver_groups)
        {
            let grounds = self.near.grounds(nearby, moving, &push.step.params);
            let who = (nearby.collider, nearby.body);
            self.passage.watch(who, collider.shape(), flight, &grounds);
        }
        blended
    }

    /// Makes parts prepare contacts with the fast bodies that may reach them during the step.
    fn set_look_ahead(&mut self, world: &mut World) {
        if self.fast.is_empty() && !self.looked_ahead {
            return;
        }
        self.looked_ahead = !self.fast.is_empty();
        for part in self.near.parts() {
            let (Some(body), Some(collider)) = (world.bodies.get(part.body), world.colliders.get(part.collider)) else {
                continue;
            };
            let Some(patch) = collider.shape().as_shape::<Patch>() else {
                continue;
            };
            // How far the part itself moves.
            let moves = body.soft_ccd_prediction();
            let bounds = patch.triangles.compute_aabb(body.position()).loosened(moves);
            let meeting = self.fast.iter().filter(|(fast, _)| fast.intersects(&bounds));
            let look_ahead = meeting.map(|&(_, look_ahead)| look_ahead).fold(0.0, f32::max);
            patch.look_ahead.set(look_ahead);
            // A change of the collider wakes what sleeps on it, so the box never shrinks.
            if patch.reach < look_ahead
                && let Some(collider) = world.colliders.get_mut(part.collider)
                && let Some(patch) = collider.shape_mut().as_shape_mut::<Patch>()
            {
                patch.reach = look_ahead;
            }
        }
        self.fast.clear();
    }

    /// Disables parts that are not joined to their carrier in this step. They would act as separate obstacles.
    fn leave_out_unlinked(&self, carrier: &Carrier, colliders: &mut ColliderSet) {
        for part in self.near.parts() {
            let is_linked = carrier.links.iter().any(|link| link.part == part.body);
            if let Some(collider) = colliders.get_mut(part.collider)
                && collider.is_enabled() != is_linked
            {
                collider.set_enabled(is_linked);
            }
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
        (simulation, bodies, colliders): (&RapierContextSimulation, &mut RigidBodySet, &mut ColliderSet),
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

    fn name_parts(&self, name: u128, colliders: &mut ColliderSet) {
        for part in self.near.parts() {
            if let Some(collider) = colliders.get_mut(part.collider) {
                collider.user_data = name;
            }
        }
    }

    fn update_material(&mut self, material: ContactMaterial, colliders: &mut ColliderSet) {
        if self.material == Some(material) {
            return;
        }
        self.material = Some(material);
        for part in self.near.parts() {
            if let Some(collider) = colliders.get_mut(part.collider) {
                material.apply_to(collider);
            }
        }
    }
}
