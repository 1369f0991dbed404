//! The patches of a surface that are near moving bodies, as kinematic bodies that move as the surface does.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy::math::DVec3;
use bevy::platform::collections::HashMap;
use bevy::prelude::Entity;
use bevy_rapier3d::parry::bounding_volume::Aabb;
use bevy_rapier3d::parry::bounding_volume::BoundingVolume;
use bevy_rapier3d::parry::math::Pose as Place;
use bevy_rapier3d::parry::shape::{SharedShape, Triangle};
use bevy_rapier3d::rapier::dynamics::{
    CoefficientCombineRule, ImpulseJointSet, IslandManager, MultibodyJointSet, RigidBody, RigidBodyBuilder,
    RigidBodyHandle, RigidBodySet, SoftBodySet,
};
use bevy_rapier3d::rapier::geometry::{
    ActiveCollisionTypes, Collider as RapierCollider, ColliderBuilder, ColliderHandle, ColliderSet, InteractionGroups,
};
use bevy_rapier3d::rapier::pipeline::ActiveHooks;
use morph_collision::{Body, ConvexRegion, MorphBvh, OverlapQuery};

use super::follow::Following;
use super::motion::{RigidMotion, continuous};
use super::patches::Patches;
use super::triangles::{Patch, Triangles};

/// A collider of a dynamic body.
pub(super) struct Mover {
    pub(super) collider: ColliderHandle,
    pub(super) body: RigidBodyHandle,
    /// Where it may be during the step.
    pub(super) bounds: Aabb,
    pub(super) asleep: bool,
    pub(super) groups: InteractionGroups,
    pub(super) hooks: ActiveHooks,
}

/// What patches change in a physics world.
pub(super) struct World<'a> {
    pub(super) bodies: &'a mut RigidBodySet,
    pub(super) colliders: &'a mut ColliderSet,
    pub(super) islands: &'a mut IslandManager,
    pub(super) impulse_joints: &'a mut ImpulseJointSet,
    pub(super) multibody_joints: &'a mut MultibodyJointSet,
    pub(super) soft_bodies: &'a mut SoftBodySet,
}

impl World<'_> {
    fn remove(&mut self, body: RigidBodyHandle) {
        let World {
            bodies,
            colliders,
            islands,
            impulse_joints,
            multibody_joints,
            soft_bodies,
        } = self;
        bodies.remove(
            body,
            islands,
            colliders,
            impulse_joints,
            multibody_joints,
            soft_bodies,
            true,
        );
    }
}

/// What a patch has from the collider that it is a part of.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Manners {
    friction: f32,
    friction_rule: CoefficientCombineRule,
    restitution: f32,
    restitution_rule: CoefficientCombineRule,
    pub(super) contact_skin: f32,
    groups: InteractionGroups,
    solver_groups: InteractionGroups,
    hooks: ActiveHooks,
}

impl Manners {
    pub(super) fn of(collider: &RapierCollider, solver_groups: InteractionGroups) -> Self {
        Self {
            friction: collider.friction(),
            friction_rule: collider.friction_combine_rule(),
            restitution: collider.restitution(),
            restitution_rule: collider.restitution_combine_rule(),
            contact_skin: collider.contact_skin(),
            groups: collider.collision_groups(),
            solver_groups,
            hooks: collider.active_hooks(),
        }
    }

    fn teach(&self, collider: &mut RapierCollider) {
        collider.set_friction(self.friction);
        collider.set_friction_combine_rule(self.friction_rule);
        collider.set_restitution(self.restitution);
        collider.set_restitution_combine_rule(self.restitution_rule);
        collider.set_contact_skin(self.contact_skin);
        collider.set_collision_groups(self.groups);
        collider.set_solver_groups(self.solver_groups);
        collider.set_active_hooks(self.hooks);
    }
}

/// The patches of one surface that bodies are near.
pub(super) struct Pushing {
    entity: Entity,
    patches: Arc<Patches>,
    /// What is near each collider.
    near: HashMap<ColliderHandle, Near>,
    active: HashMap<u32, ActivePatch>,
    manners: Option<Manners>,
    /// Whether patches go without a name, so that Rapier tells nobody of their contacts.
    nameless: bool,
    step: u32,
    scratch: Scratch,
}

/// What is near a collider that may move.
struct Near {
    body: RigidBodyHandle,
    /// Everything in here is known, for the surface as it was last looked at.
    region: Aabb,
    patches: Vec<u32>,
    /// Those before the surface moved.
    earlier: Vec<u32>,
    seen: u32,
}

/// A patch in the physics world.
struct ActivePatch {
    body: RigidBodyHandle,
    collider: ColliderHandle,
    /// Triangle numbers, and corners as places among the vertices.
    numbers: Vec<u32>,
    corners: Vec<[usize; 3]>,
    vertices: Vec<u32>,
    /// Whether it stands where the surface is now, and does not move.
    settled: bool,
    /// The last step in which a body was near.
    needed: u32,
}

#[derive(Default)]
struct Scratch {
    overlap: OverlapQuery,
    triangles: Vec<u32>,
    now: Vec<DVec3>,
    before: Vec<DVec3>,
    past: Vec<DVec3>,
    velocities: Vec<DVec3>,
    velocities_before: Vec<DVec3>,
    to_wake: Vec<RigidBodyHandle>,
}

/// Steps for which a patch stays when no body is near it any more: bodies that bounce come back.
const PATIENCE: u32 = 8;

/// What a step is about.
pub(super) struct Step<'a> {
    pub(super) dt: f32,
    pub(super) movers: &'a [Mover],
    /// How far away a contact is prepared.
    pub(super) prediction: f32,
    pub(super) max_acceleration: f32,
    pub(super) stepping: &'a Arc<AtomicBool>,
}

impl Pushing {
    pub(super) fn new(entity: Entity, patches: Arc<Patches>) -> Self {
        Self {
            entity,
            patches,
            near: HashMap::default(),
            active: HashMap::default(),
            manners: None,
            nameless: false,
            step: 0,
            scratch: Scratch::default(),
        }
    }

    pub(super) fn is_idle(&self) -> bool {
        self.near.is_empty() && self.active.is_empty()
    }

    /// How many patches are in the physics world.
    pub(super) fn active(&self) -> u32 {
        self.active.len() as u32
    }

    /// Takes all patches out of the world.
    pub(super) fn stop(&mut self, world: &mut World) {
        for (_, patch) in self.active.drain() {
            world.remove(patch.body);
        }
        self.near.clear();
        self.manners = None;
    }

    /// Sees to it that during the step to come whatever may meet the surface meets patches that move as it does.
    ///
    /// Says how many patches had to be blended.
    pub(super) fn prepare(
        &mut self,
        following: &mut Following,
        manners: Manners,
        step: &Step,
        world: &mut World,
    ) -> u32 {
        self.step = self.step.wrapping_add(1);
        let moves = following.moves;
        let bounds = following.bounds();
        let bounds = Aabb::new(bounds.min, bounds.max).loosened(step.prediction);
        let mut busy = self.active.values().any(|patch| !patch.settled);
        let mut hooks = manners.hooks;
        for mover in step.movers {
            let near = mover.bounds.intersects(&bounds) && mover.groups.test(manners.groups);
            if !near || (mover.asleep && !moves) {
                continue;
            }
            busy = true;
            hooks |= mover.hooks;
            self.look_near(mover, following, step);
        }
        if !busy && self.is_idle() {
            return 0;
        }
        self.forget(world);
        if self.manners != Some(manners) {
            self.manners = Some(manners);
            for patch in self.active.values() {
                if let Some(collider) = world.colliders.get_mut(patch.collider) {
                    manners.teach(collider);
                }
            }
        }
        let mut blended = 0;
        if busy {
            blended = self.move_patches(following, manners, step, world);
            // Hooks are given entities, and cannot do without; events without one are not sent.
            self.nameless = hooks.is_empty();
            self.name_patches(if self.nameless { 0 } else { self.name() }, world.colliders);
        }
        for &body in &self.scratch.to_wake {
            world.islands.wake_up(world.bodies, body, true);
        }
        self.scratch.to_wake.clear();
        blended
    }

    /// Patches are known as their surface again.
    pub(super) fn finish(&mut self, colliders: &mut ColliderSet) {
        if std::mem::take(&mut self.nameless) {
            self.name_patches(self.name(), colliders);
        }
    }

    fn name(&self) -> u128 {
        u128::from(self.entity.to_bits())
    }

    fn name_patches(&self, name: u128, colliders: &mut ColliderSet) {
        for patch in self.active.values() {
            if let Some(collider) = colliders
                .get_mut(patch.collider)
                .filter(|collider| collider.user_data != name)
            {
                collider.user_data = name;
            }
        }
    }

    /// Finds the patches that a collider may touch.
    fn look_near(&mut self, mover: &Mover, following: &mut Following, step: &Step) {
        let seen = self.step;
        let near = self.near.entry(mover.collider).or_insert_with(|| Near {
            body: mover.body,
            region: Aabb::new_invalid(),
            patches: Vec::new(),
            earlier: Vec::new(),
            seen,
        });
        near.seen = seen;
        if !following.moves && near.region.contains(&mover.bounds) {
            near.earlier.clear();
            return;
        }
        // Somewhat more than asked for, so that a body that trembles does not ask every time.
        let room = step.prediction + 0.1 * mover.bounds.extents().max_element();
        near.region = mover.bounds.loosened(room);
        std::mem::swap(&mut near.patches, &mut near.earlier);
        near.patches.clear();
        let Scratch { overlap, triangles, .. } = &mut self.scratch;
        triangles.clear();
        let bounds = morph_collision::Aabb {
            min: near.region.mins,
            max: near.region.maxs,
        };
        if let Ok(region) = ConvexRegion::from_box(&bounds) {
            let mut posed = following.surface.lock();
            let body = Body::new(&mut posed.pose, &following.world_from_model);
            overlap.triangles_in_region(body, &region, triangles);
        }
        let patches = triangles.iter().map(|&triangle| self.patches.patch_of(triangle));
        near.patches.extend(patches);
        near.patches.sort_unstable();
        near.patches.dedup();
        if !following.moves {
            near.earlier.clear();
        }
    }

    /// Lets go of colliders that went away, and of patches that nothing is near.
    fn forget(&mut self, world: &mut World) {
        let step = self.step;
        self.near.retain(|_, near| {
            let asleep = || world.bodies.get(near.body).is_some_and(RigidBody::is_sleeping);
            near.seen == step || asleep()
        });
        for near in self.near.values() {
            for patch in near.patches.iter().chain(&near.earlier) {
                if let Some(patch) = self.active.get_mut(patch) {
                    patch.needed = step;
                }
            }
        }
        self.active.retain(|_, patch| {
            let stays = step.wrapping_sub(patch.needed) <= PATIENCE;
            if !stays {
                world.remove(patch.body);
            }
            stays
        });
    }

    fn move_patches(&mut self, following: &mut Following, manners: Manners, step: &Step, world: &mut World) -> u32 {
        let mut blended = 0;
        let moves = following.moves;
        for near in self.near.values() {
            // What sleeps where nothing moves needs nothing.
            if near.seen != self.step {
                continue;
            }
            for &number in near.patches.iter().chain(&near.earlier) {
                self.active.entry(number).or_insert_with(|| {
                    let bvh = following.before.pose.bvh().clone();
                    let mut patch = ActivePatch::new(&bvh, self.patches.triangles(number));
                    patch.needed = self.step;
                    patch
                });
            }
        }
        for (_, patch) in &mut self.active {
            if moves || !patch.settled {
                blended += 1;
                patch.update(following, manners, step, self.entity, world, &mut self.scratch);
            }
        }
        if moves {
            // Whatever sleeps on a patch that moved is woken.
            for near in self.near.values() {
                let asleep = world.bodies.get(near.body).is_some_and(RigidBody::is_sleeping);
                let on = |patch: &u32| self.active.get(patch).is_some_and(|patch| !patch.settled);
                if asleep && near.patches.iter().chain(&near.earlier).any(on) {
                    self.scratch.to_wake.push(near.body);
                }
            }
        }
        blended
    }
}

impl ActivePatch {
    fn new(bvh: &MorphBvh, triangles: &[u32]) -> Self {
        let mut vertices: Vec<u32> = triangles
            .iter()
            .flat_map(|&triangle| bvh.model().triangle(triangle as usize))
            .collect();
        vertices.sort_unstable();
        vertices.dedup();
        let place = |vertex: u32| vertices.binary_search(&vertex).unwrap_or(0);
        let corners = triangles
            .iter()
            .map(|&triangle| bvh.model().triangle(triangle as usize));
        Self {
            body: RigidBodyHandle::invalid(),
            collider: ColliderHandle::invalid(),
            numbers: triangles.to_vec(),
            corners: corners.map(|corners| corners.map(place)).collect(),
            vertices,
            settled: false,
            needed: 0,
        }
    }

    /// Puts the patch where the surface is at the begin of the step, moving as the surface does until its end.
    fn update(
        &mut self,
        following: &mut Following,
        manners: Manners,
        step: &Step,
        entity: Entity,
        world: &mut World,
        scratch: &mut Scratch,
    ) {
        following.vertices(&self.vertices, &mut scratch.now);
        let velocities = following.moves && self.velocities(following, step, scratch);
        let start = if velocities { &scratch.before } else { &scratch.now };
        if start.is_empty() || !start.iter().all(|vertex| vertex.as_vec3().is_finite()) {
            // Where no number can say. What was good before stays.
            return;
        }
        let mean = start.iter().sum::<DVec3>() / start.len() as f64;
        let origin = mean.as_vec3();
        let relative: Vec<DVec3> = start.iter().map(|vertex| vertex - origin.as_dvec3()).collect();
        let motion = if velocities {
            RigidMotion::fitted(&relative, &scratch.velocities)
        } else {
            RigidMotion::default()
        };
        self.settled = !following.moves || (velocities && scratch.velocities.iter().all(|&v| v == DVec3::ZERO));
        let speed = if velocities {
            scratch.velocities.iter().map(|v| v.length()).fold(0.0, f64::max)
        } else {
            0.0
        };

        let corners = self.corners.iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| relative[corner].as_vec3());
            Triangle::new(a, b, c)
        });
        let patch = Patch {
            triangles: Triangles::new(self.numbers.clone(), corners.collect()),
            stepping: step.stepping.clone(),
        };
        let (linear, angular) = (motion.linear.as_vec3(), motion.angular.as_vec3());
        let place = Place::from_translation(origin);
        if let Some(body) = world.bodies.get_mut(self.body) {
            body.set_position(place, false);
            body.set_linvel(linear, false);
            body.set_angvel(angular, false);
            body.set_soft_ccd_prediction(speed as f32 * step.dt);
            if let Some(collider) = world.colliders.get_mut(self.collider) {
                collider.set_shape(SharedShape::new(patch));
            }
        } else {
            let body = RigidBodyBuilder::kinematic_velocity_based()
                .pose(place)
                .linvel(linear)
                .angvel(angular)
                .soft_ccd_prediction(speed as f32 * step.dt)
                .user_data(u128::from(entity.to_bits()));
            self.body = world.bodies.insert(body);
            let mut collider = ColliderBuilder::new(SharedShape::new(patch))
                .density(0.0)
                .active_collision_types(ActiveCollisionTypes::DYNAMIC_KINEMATIC)
                .build();
            manners.teach(&mut collider);
            self.collider = world.colliders.insert_with_parent(collider, self.body, world.bodies);
        }
    }

    /// Finds what velocity each vertex has, and whether that is a motion rather than a jump.
    fn velocities(&self, following: &mut Following, step: &Step, scratch: &mut Scratch) -> bool {
        let Scratch {
            now,
            before,
            past,
            velocities,
            velocities_before,
            ..
        } = scratch;
        following.before.vertices(&self.vertices, before);
        let between = |from: &[DVec3], to: &[DVec3], dt: f32, into: &mut Vec<DVec3>| {
            into.clear();
            into.extend(from.iter().zip(to).map(|(from, to)| (to - from) / f64::from(dt)));
        };
        between(before, now, step.dt, velocities);
        let limit = f64::from(step.max_acceleration * step.dt);
        if continuous(velocities, None, limit) {
            return true;
        }
        let Some(last_step) = following.moved_for else {
            return false;
        };
        following.past.vertices(&self.vertices, past);
        between(past, before, last_step, velocities_before);
        continuous(velocities, Some(velocities_before), limit)
    }
}

/// No groups at all: a collider with these meets what it meets, and pushes nothing.
pub(super) fn no_push(groups: InteractionGroups) -> InteractionGroups {
    InteractionGroups::new(
        bevy_rapier3d::rapier::geometry::Group::NONE,
        bevy_rapier3d::rapier::geometry::Group::NONE,
        groups.test_mode,
    )
}
