//! Before a step: puts parts near everything that may touch a surface.

use bevy_morph_physics::moving::MovingSurface;
use bevy_morph_physics::push::{NearbyCollider, StepParams};
use bevy_morph_physics::shape::Patch;
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::shape::Shape;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::{ColliderHandle, ColliderSet};
use bevy_rapier3d::rapier::pipeline::ActiveEvents;

use super::expel::drive_out;
use super::link::Carrier;
use super::material::ContactMaterial;
use super::movers::Mover;
use super::part::PartBodies;
use super::pushing::Pushing;
use super::step::Step;
use super::world::World;

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
            searching.push((mover, self.search(nearby, moving, &step.params, reach)));
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

    /// Finds the triangles that a collider may touch. Returns whether there are any.
    fn search(
        &mut self,
        nearby: &NearbyCollider<ColliderHandle, RigidBodyHandle>,
        moving: &mut MovingSurface,
        params: &StepParams,
        reach: f32,
    ) -> bool {
        if self.linked {
            self.near.search_anew(nearby, moving, reach)
        } else {
            self.near.search(nearby, moving, params)
        }
    }

    /// Decides whether parts have the name of their surface in the step, so that Rapier reports their contacts.
    fn choose_names(
        &mut self,
        events: ActiveEvents,
        step: &Step,
        busy: bool,
        bounds: &Aabb,
        moving: &mut MovingSurface,
        colliders: &mut ColliderSet,
    ) {
        let listening = step.listeners.listens || events.contains(ActiveEvents::COLLISION_EVENTS);
        moving.surface.set_quiet(!listening);
        if busy && (listening || events.contains(ActiveEvents::CONTACT_FORCE_EVENTS)) {
            // The surface reports its contacts as a whole, and parts without a name report nothing. Hooks receive the names of
            // colliders, so they need named parts.
            let hooked = step
                .listeners
                .hooks_near(&bounds.loosened(moving.displacement() as f32));
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
            self.passage
                .watch(nearby.collider, nearby.body, collider.shape(), flight, &grounds);
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
