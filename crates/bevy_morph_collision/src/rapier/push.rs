//! How a surface pushes: with parts near moving bodies, as kinematic Rapier bodies.

use std::sync::Arc;

use bevy::math::Vec3;
use bevy::prelude::Entity;
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::query::Ray;
use bevy_rapier3d::parry::shape::Shape;
use bevy_rapier3d::plugin::context::RapierContextSimulation;
use bevy_rapier3d::prelude::ContactForceEvent;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle, ColliderSet};
use bevy_rapier3d::rapier::pipeline::{ActiveEvents, QueryFilter};

use super::expel::{drive_apart, drive_out};
use super::forces::{Forces, Stepped};
use super::link::Carrier;
use super::part::{PartBodies, PartHandles};
use super::spared::Spared;
use super::world::{Manners, Step, World};
use crate::physics::expel::Expelling;
use crate::physics::follow::Following;
use crate::physics::layout::MeshLayout;
use crate::physics::near::Nearby;
use crate::physics::passage::{Budget, Passage, middle};
use crate::physics::surface::MorphSurface;
use crate::physics::triangles::Patch;

/// The parts with which a surface pushes.
pub(super) struct Pushing {
    entity: Entity,
    near: Nearby<ColliderHandle, RigidBodyHandle, PartHandles>,
    /// Whether its parts are links of a dynamic body.
    linked: bool,
    manners: Option<Manners>,
    /// Whether parts have no name, so that Rapier does not report their contacts.
    nameless: bool,
    /// Whether Rapier reports contacts of parts in addition to those of the whole surface.
    pub(super) repeats: bool,
    forces: Forces,
    spared: Spared,
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

impl Pushing {
    pub(super) fn new(entity: Entity, layout: Arc<MeshLayout>) -> Self {
        Self {
            entity,
            near: Nearby::new(layout),
            linked: false,
            manners: None,
            nameless: false,
            repeats: false,
            forces: Forces::default(),
            spared: Spared::default(),
            expelling: Expelling::default(),
            passage: Passage::default(),
            bullets: Vec::new(),
            looked_ahead: false,
            meeting: Vec::new(),
            fast: Vec::new(),
        }
    }

    pub(super) fn is_idle(&self) -> bool {
        self.near.is_idle()
    }

    /// The number of parts in the physics world.
    pub(super) fn parts(&self) -> u32 {
        self.near.parts().count() as u32
    }

    /// Removes all parts from the world and forgets what was near.
    pub(super) fn stop(&mut self, world: &mut World) {
        self.expelling.stop();
        self.stop_parts(world);
    }

    /// Removes all parts from the world.
    pub(super) fn stop_parts(&mut self, world: &mut World) {
        if !self.is_idle() {
            self.near.stop(|part| world.remove(part.body));
            self.manners = None;
        }
    }

    /// Prepares the coming step: everything that may touch the surface will touch parts that move like it.
    ///
    /// With a `carrier`, there are parts for everything that the surface may touch, fixed or not. The caller must join these
    /// parts to the carrier before the step.
    ///
    /// Returns how many parts had to be blended.
    pub(super) fn prepare(
        &mut self,
        following: &mut Following,
        manners: Manners,
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
        self.near.begin(following);
        self.passage.begin();
        let is_solid = following.surface.lock().is_solid() && !self.linked;
        if !self.linked {
            self.expelling.begin(None);
        }
        let reach = step.pace.prediction + carrier.as_ref().map_or(0.0, |carrier| carrier.way);
        let bounds = following.bounds();
        let bounds = Aabb::new(bounds.min, bounds.max).loosened(reach);
        self.teach(manners, world.colliders);
        self.spared.find(step.body, world);
        let obstacles = step.obstacles.filter(|_| self.linked);
        let obstacles = obstacles.map_or_else(Vec::new, |all| all.within(&bounds, step.pace.dt, world));

        let (mut blended, mut looking) = (0, Vec::new());
        let mut events = manners.events;
        for mover in step.movers.meeting(&bounds, &mut self.meeting).chain(&obstacles) {
            let visitor = &mover.visitor;
            if carrier.as_ref().is_some_and(|carrier| carrier.has(mover)) {
                continue;
            }
            if !mover.groups.test(manners.groups) || self.spared.contains(visitor.body) {
                continue;
            }
            events |= mover.events;
            if self.near.sleeps_on(visitor, following) {
                self.expelling.keep(visitor.collider);
                continue;
            }
            let touches = if self.linked {
                self.near.look_anew(visitor, following, reach)
            } else {
                self.near.look_near(visitor, following, &step.pace)
            };
            looking.push((mover, touches));
        }
        let busy = !looking.is_empty();
        let stays = self.near.stays(following);
        if busy && !stays {
            let is_asleep = |body| world.bodies.get(body).is_some_and(RigidBody::is_sleeping);
            self.near.give_out(following, is_asleep);
        }
        for (mover, touches) in looking {
            let visitor = &mover.visitor;
            let is_inside = is_solid && drive_out(&mut self.expelling, mover, following, &manners, step, world);
            if touches && mover.ahead > 0.0 {
                self.fast.push((visitor.bounds, mover.ahead));
            }
            // Rapier sweeps fast bodies against fixed ones, but against kinematic ones, such as parts, only if they are bullets.
            // A body on its way out must not be a bullet, because the surface would stop it.
            if touches
                && (mover.fast || is_inside)
                && let Some(body) = world.bodies.get_mut(visitor.body)
                && body.is_ccd_enabled() == is_inside
            {
                body.enable_ccd(!is_inside);
                self.bullets.push((visitor.body, mover.bullet));
            }
            if !stays {
                let mut bodies = PartBodies {
                    entity: self.entity,
                    manners,
                    stepping: step.stepping,
                    carrier: carrier.as_deref_mut(),
                    world: &mut *world,
                };
                blended += self.near.push(visitor, following, &step.pace, &mut bodies);
            }
            // After several steps, nobody knows which way a body went.
            if step.once
                && !self.linked
                && !manners.is_hooked()
                && let Some(flight) = &mover.flight
                && let Some(collider) = world.colliders.get(visitor.collider)
                // Whether the solver pushes it away from the surface.
                && collider.solver_groups().test(manners.solver_groups)
            {
                let grounds = self.near.grounds(visitor, following, &step.pace);
                let who = (visitor.collider, visitor.body);
                self.passage.watch(who, collider.shape(), flight, &grounds);
            }
        }
        self.near.forget(|part| world.remove(part.body));
        self.look_ahead(world);
        if let Some(carrier) = carrier {
            self.leave_out_unlinked(carrier, world.colliders);
        } else {
            self.expelling.forget();
        }
        for body in self.near.take_to_wake() {
            world.islands.wake_up(world.bodies, body, true);
        }
        let listening = step.audience.listens || events.contains(ActiveEvents::COLLISION_EVENTS);
        following.surface.set_quiet(!listening);
        if busy && (listening || events.contains(ActiveEvents::CONTACT_FORCE_EVENTS)) {
            // The surface reports its contacts as a whole, and parts without a name report nothing. Hooks receive the names of
            // colliders, so they need named parts.
            let hooked = step
                .audience
                .hooks_near(&bounds.loosened(following.displacement as f32));
            self.repeats = listening && hooked;
            self.nameless = !hooked;
            if self.nameless {
                self.name_parts(0, world.colliders);
            }
        }
        self.spared.guard(self.near.parts().map(|part| part.body), world);
        blended
    }

    /// Makes parts prepare contacts with the fast bodies that may reach them during the step.
    fn look_ahead(&mut self, world: &mut World) {
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
            let ahead = meeting.map(|&(_, ahead)| ahead).fold(0.0, f32::max);
            patch.ahead.set(ahead);
            // A change of the collider wakes what sleeps on it, so the box never shrinks.
            if patch.reach < ahead
                && let Some(collider) = world.colliders.get_mut(part.collider)
                && let Some(patch) = collider.shape_mut().as_shape_mut::<Patch>()
            {
                patch.reach = ahead;
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
    pub(super) fn stop_driving(&mut self) {
        self.expelling.stop();
    }

    /// Drives bodies out of a surface on a dynamic body.
    pub(super) fn drive_apart(
        &mut self,
        collider: ColliderHandle,
        following: &mut Following,
        manners: &Manners,
        step: &Step,
        world: &mut World,
    ) {
        self.spared.find(step.body, world);
        drive_apart(
            &mut self.expelling,
            collider,
            following,
            manners,
            &self.spared,
            step,
            world,
        );
    }

    /// Reports the contact forces of the surface in the step, if Rapier did not report those of its parts.
    pub(super) fn tell_forces(&mut self, stepped: &Stepped, tell: &mut impl FnMut(ContactForceEvent)) {
        if self.nameless {
            let parts = self.near.parts().map(|part| part.collider);
            self.forces.tell(self.entity, parts, stepped, tell);
        }
    }

    /// After a step, moves bodies back that have passed through the surface.
    pub(super) fn hold_back(
        &mut self,
        following: &mut Following,
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
        let shifts = self.passage.hold_back(following, budget, end, is_blocked);
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
    pub(super) fn finish(&mut self, surface: &MorphSurface, bodies: &mut RigidBodySet, colliders: &mut ColliderSet) {
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

    fn teach(&mut self, manners: Manners, colliders: &mut ColliderSet) {
        if self.manners == Some(manners) {
            return;
        }
        self.manners = Some(manners);
        for part in self.near.parts() {
            if let Some(collider) = colliders.get_mut(part.collider) {
                manners.teach(collider);
            }
        }
    }
}
