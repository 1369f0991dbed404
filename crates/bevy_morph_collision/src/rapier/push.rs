//! The parts of a surface that are near moving bodies.

use std::sync::Arc;

use bevy::platform::collections::HashMap;
use bevy::prelude::Entity;
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderHandle, ColliderSet};
use bevy_rapier3d::rapier::pipeline::ActiveEvents;
use morph_collision::ShapeQuery;

use super::follow::Following;
use super::layout::MeshLayout;
use super::part::{Part, PartScratch, Purpose};
use super::surface::MorphSurface;
use super::world::{Manners, Mover, Step, World};

/// What a surface pushes with. For each collider near it there is a part of the surface, or several where it moves too
/// differently for one. A triangle is in one of them at most.
pub(super) struct Pushing {
    entity: Entity,
    layout: Arc<MeshLayout>,
    near: HashMap<ColliderHandle, Near>,
    manners: Option<Manners>,
    /// Whether parts go without a name, so that Rapier tells nobody of their contacts.
    nameless: bool,
    /// Bodies that are bullets for this step.
    bullets: Vec<RigidBodyHandle>,
    step: u32,
    scratch: Scratch,
}

/// What is near a collider that may move.
struct Near {
    body: RigidBodyHandle,
    /// All triangles in here are known, for the surface as it was when it was looked at.
    region: Aabb,
    triangles: Vec<u32>,
    /// How far the surface had travelled by then.
    travelled: f64,
    parts: Vec<Part>,
    /// Into how many parts triangles are cut.
    cut: usize,
    /// The last step in which the collider was near.
    seen: u32,
}

/// Parts for one collider at most.
const MAX_CUT: usize = 8;

#[derive(Default)]
struct Scratch {
    shapes: ShapeQuery,
    /// For each triangle of the mesh the last step in which a part had it.
    taken: Vec<u32>,
    free: Vec<u32>,
    part: PartScratch,
    to_wake: Vec<RigidBodyHandle>,
}

impl Pushing {
    pub(super) fn new(entity: Entity, layout: Arc<MeshLayout>) -> Self {
        Self {
            entity,
            layout,
            near: HashMap::default(),
            manners: None,
            nameless: false,
            bullets: Vec::new(),
            step: 0,
            scratch: Scratch::default(),
        }
    }

    pub(super) fn is_idle(&self) -> bool {
        self.near.is_empty()
    }

    /// How many parts are in the physics world.
    pub(super) fn parts(&self) -> u32 {
        self.near.values().map(|near| near.parts.len() as u32).sum()
    }

    /// Takes all parts out of the world.
    pub(super) fn stop(&mut self, world: &mut World) {
        for (_, mut near) in self.near.drain() {
            near.parts.iter_mut().for_each(|part| part.remove(world));
        }
        self.manners = None;
        self.scratch = Scratch::default();
    }

    /// Sees to it that during the step to come whatever may meet the surface meets parts that move as it does.
    ///
    /// Says how many parts had to be blended.
    pub(super) fn prepare(
        &mut self,
        following: &mut Following,
        manners: Manners,
        step: &Step,
        world: &mut World,
    ) -> u32 {
        if step.movers.is_empty() && self.is_idle() {
            return 0;
        }
        self.step += 1;
        let bounds = following.bounds();
        let bounds = Aabb::new(bounds.min, bounds.max).loosened(step.prediction);
        self.teach(manners, world.colliders);

        let (mut blended, mut busy) = (0, false);
        let mut events = manners.events;
        for mover in step.movers {
            if !mover.bounds.intersects(&bounds) || !mover.groups.test(manners.groups) {
                continue;
            }
            let restless = |near: &Near| near.parts.iter().any(|part| !part.is_settled());
            events |= mover.events;
            if mover.asleep && !following.moves {
                let near = self.near.get_mut(&mover.collider);
                if let Some(near) = near.filter(|near| !restless(near)) {
                    near.seen = self.step;
                    continue;
                }
                if !self.near.contains_key(&mover.collider) {
                    continue;
                }
            }
            if !busy {
                busy = true;
                self.scratch.taken.resize(self.layout.order.len(), 0);
                if !following.moves {
                    self.keep_for_sleepers(world.bodies);
                }
            }
            let touches = self.look_near(mover, following, step);
            if mover.fast
                && touches
                && let Some(body) = world.bodies.get_mut(mover.body)
            {
                // Rapier sweeps what is fast against what is fixed, and only bullets against what is kinematic, as parts are.
                body.enable_ccd(true);
                self.bullets.push(mover.body);
            }
            blended += self.push(mover, following, manners, step, world);
        }
        self.forget(world);
        for &body in &self.scratch.to_wake {
            world.islands.wake_up(world.bodies, body, true);
        }
        self.scratch.to_wake.clear();
        let listening = step.audience.listens || events.contains(ActiveEvents::COLLISION_EVENTS);
        following.surface.set_quiet(!listening);
        if busy && listening && !step.audience.hooked {
            // The surface tells of what it touches as a whole: of parts without a name nothing is told. Hooks are given names, and
            // cannot do without.
            self.nameless = true;
            self.name_parts(0, world.colliders);
        }
        blended
    }

    /// Parts are known as their surface again.
    pub(super) fn finish(&mut self, surface: &MorphSurface, bodies: &mut RigidBodySet, colliders: &mut ColliderSet) {
        surface.set_quiet(false);
        if std::mem::take(&mut self.nameless) {
            self.name_parts(self.name(), colliders);
        }
        for body in self.bullets.drain(..) {
            if let Some(body) = bodies.get_mut(body) {
                body.enable_ccd(false);
            }
        }
    }

    fn name(&self) -> u128 {
        u128::from(self.entity.to_bits())
    }

    fn name_parts(&self, name: u128, colliders: &mut ColliderSet) {
        for part in self.near.values().flat_map(|near| &near.parts) {
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
        for part in self.near.values().flat_map(|near| &near.parts) {
            if let Some(collider) = colliders.get_mut(part.collider) {
                manners.teach(collider);
            }
        }
    }

    /// What bodies sleep on while nothing moves is not given to others.
    fn keep_for_sleepers(&mut self, bodies: &RigidBodySet) {
        for near in self.near.values() {
            let asleep = bodies.get(near.body).is_some_and(RigidBody::is_sleeping);
            if asleep && near.parts.iter().all(Part::is_settled) {
                for &triangle in near.parts.iter().flat_map(Part::triangles) {
                    self.scratch.taken[triangle as usize] = self.step;
                }
            }
        }
    }

    /// Finds the triangles that a collider may touch; says whether there are any.
    fn look_near(&mut self, mover: &Mover, following: &mut Following, step: &Step) -> bool {
        let near = self.near.entry(mover.collider).or_insert_with(|| Near {
            body: mover.body,
            region: Aabb::new_invalid(),
            triangles: Vec::new(),
            travelled: 0.0,
            parts: Vec::new(),
            cut: 1,
            seen: 0,
        });
        near.seen = self.step;
        // Wherever a vertex is during the step, it ends this near; and somewhat more, not to look again every time.
        let room = following.displacement as f32 + 0.1 * mover.bounds.extents().max_element();
        let region = mover.bounds.loosened(step.prediction + room);
        let travelled = (following.travelled - near.travelled) as f32;
        let known = near
            .region
            .contains(&mover.bounds.loosened(step.prediction + travelled));
        // After a jump it is far larger than need be, and what others stand on is in it.
        if known && near.region.extents().cmple(2.0 * region.extents()).all() {
            return !near.triangles.is_empty();
        }
        near.region = region;
        near.travelled = following.travelled;
        near.triangles.clear();
        following.triangles_in(&near.region, &mut self.scratch.shapes, &mut near.triangles);
        !near.triangles.is_empty()
    }

    /// Puts what a collider may touch before it; says how many parts were blended.
    fn push(
        &mut self,
        mover: &Mover,
        following: &mut Following,
        manners: Manners,
        step: &Step,
        world: &mut World,
    ) -> u32 {
        let Self {
            near, scratch, layout, ..
        } = self;
        let Some(near) = near.get_mut(&mover.collider) else {
            return 0;
        };
        scratch.free.clear();
        for &triangle in &near.triangles {
            let taken = &mut scratch.taken[triangle as usize];
            if std::mem::replace(taken, self.step) != self.step {
                scratch.free.push(triangle);
            }
        }
        let cut = near.cut.min(scratch.free.len());
        if cut > 1 {
            scratch
                .free
                .sort_unstable_by_key(|&triangle| layout.order[triangle as usize]);
        }
        let each = scratch.free.len().div_ceil(cut.max(1)).max(1);
        let parts = scratch.free.chunks(each);
        while near.parts.len() > parts.len() {
            near.parts.pop().into_iter().for_each(|mut part| part.remove(world));
        }
        near.parts.resize_with(parts.len(), Part::new);

        let purpose = Purpose {
            entity: self.entity,
            manners,
            center: mover.bounds.center().as_dvec3(),
            size: f64::from(mover.bounds.extents().max_element()),
        };
        let (mut blended, mut differs) = (0, false);
        let bvh = following.before.pose.bvh().clone();
        for (part, triangles) in near.parts.iter_mut().zip(parts) {
            part.take(triangles, bvh.model(), layout, &mut scratch.part);
            if following.moves || !part.is_settled() {
                blended += 1;
                differs |= part.update(following, &purpose, step, world, &mut scratch.part);
            }
        }
        if differs && near.cut < MAX_CUT {
            near.cut *= 2;
        }
        if mover.asleep && near.parts.iter().any(|part| !part.is_settled()) {
            scratch.to_wake.push(mover.body);
        }
        blended
    }

    /// Lets go of colliders that went away.
    fn forget(&mut self, world: &mut World) {
        let step = self.step;
        self.near.retain(|_, near| {
            let stays = near.seen == step;
            if !stays {
                near.parts.iter_mut().for_each(|part| part.remove(world));
            }
            stays
        });
    }
}
