//! The parts of a surface near colliders that may move.

use std::hash::Hash;
use std::sync::Arc;

use bevy::platform::collections::HashMap;
use morph_collision::ShapeQuery;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Real;

use super::collider_parts::ColliderParts;
use super::flight::Ground;
use super::moved::Moved;
use super::part::{Bodies, Part, PartBuffers, StepParams, TargetCollider};
use crate::moving::MovingSurface;
use crate::shape::MeshLayout;

/// A collider that may move and may touch a surface.
///
/// `C` identifies a collider in the physics engine, `B` a body.
#[derive(Clone, Copy)]
pub struct NearbyCollider<C, B> {
    /// Identifies the collider.
    pub collider: C,
    /// Its body.
    pub body: B,
    /// The box in which it stays during the step.
    pub bounds: Aabb,
    /// Whether its body is asleep.
    pub asleep: bool,
}

/// The parts of a surface near colliders: one part per collider, or several if the surface moves too differently for one. Each
/// triangle is in at most one part.
///
/// `P` represents a part in the physics engine.
pub struct NearbyParts<C, B, P> {
    layout: Arc<MeshLayout>,
    near: HashMap<C, ColliderParts<B, P>>,
    step: u32,
    /// The colliders near the surface in this step and in the last one, without those that sleep on settled parts.
    listed: [Vec<C>; 2],
    /// Whether triangles near any of them were searched in this step.
    searched: bool,
    /// The side to which contacts pushed in the last step, and whether that has just changed.
    outward: Option<Real>,
    turned: bool,
    buffers: Buffers,
    to_wake: Vec<B>,
}

/// The maximum number of parts per collider.
const MAX_CUT: usize = 8;

#[derive(Default)]
struct Buffers {
    shapes: ShapeQuery,
    /// For each triangle of the mesh, the last step in which a part contained it.
    taken: Vec<u32>,
    free: Vec<u32>,
    part: PartBuffers,
}

impl<C: Copy + Eq + Hash, B: Copy, P: Default> NearbyParts<C, B, P> {
    /// No parts yet.
    pub fn new(layout: Arc<MeshLayout>) -> Self {
        Self {
            layout,
            near: HashMap::default(),
            step: 0,
            listed: [Vec::new(), Vec::new()],
            searched: false,
            outward: None,
            turned: false,
            buffers: Buffers::default(),
            to_wake: Vec::new(),
        }
    }

    /// Whether nothing is near.
    pub fn is_idle(&self) -> bool {
        self.near.is_empty()
    }

    /// Whether triangles near a collider matter in the step, so that the surface does more than taking its pose.
    pub fn is_awake(&self) -> bool {
        !self.is_idle() && !self.listed[0].is_empty()
    }

    /// Whether a collider was near in the last step.
    pub fn knows(&self, collider: C) -> bool {
        self.near.contains_key(&collider)
    }

    /// The parts, as the physics engine represents them.
    pub fn parts(&self) -> impl Iterator<Item = &P> {
        self.near.values().flat_map(|near| &near.parts).map(|part| &part.body)
    }

    /// Removes all parts.
    pub fn stop(&mut self, mut remove: impl FnMut(P)) {
        for (_, near) in self.near.drain() {
            near.parts.into_iter().for_each(|part| remove(part.body));
        }
        self.buffers = Buffers::default();
    }

    /// Begins a step.
    pub fn begin(&mut self, moving: &MovingSurface) {
        self.step += 1;
        self.listed.swap(0, 1);
        self.listed[0].clear();
        self.searched = false;
        let outward = moving.surface.lock().outward();
        self.turned = self.outward != outward;
        self.outward = outward;
        if self.turned {
            let parts = self.near.values_mut().flat_map(|near| &mut near.parts);
            parts.for_each(Part::unsettle);
        }
    }

    /// Whether all parts stay as they are, because nothing has moved and the same colliders are near the same triangles.
    pub fn stays(&self, moving: &MovingSurface) -> bool {
        let [now, before] = &self.listed;
        // Those that are not near any more may have left triangles to others.
        let is_same = |near: &ColliderParts<B, P>| near.seen == self.step && near.is_settled();
        !moving.moves && !self.searched && now == before && self.near.values().all(is_same)
    }

    /// Begins to assign triangles to parts. While nothing moves, triangles under sleeping bodies are not given to other
    /// colliders.
    pub fn reserve_triangles(&mut self, moving: &MovingSurface, is_asleep: impl Fn(B) -> bool) {
        self.buffers.taken.resize(self.layout.order.len(), 0);
        if moving.moves {
            return;
        }
        for near in self.near.values() {
            if near.is_settled() && is_asleep(near.body) {
                for &triangle in near.parts.iter().flat_map(Part::triangles) {
                    self.buffers.taken[triangle as usize] = self.step;
                }
            }
        }
    }

    /// Whether a collider sleeps on a part that does not move, so that it needs no update.
    pub fn sleeps_on(&mut self, nearby: &NearbyCollider<C, B>, moving: &MovingSurface) -> bool {
        if !nearby.asleep || moving.moves || self.turned {
            return false;
        }
        let Some(near) = self.near.get_mut(&nearby.collider) else {
            return true;
        };
        let settled = near.is_settled();
        if settled {
            near.seen = self.step;
        }
        settled
    }

    /// Finds the triangles that a collider may touch. Returns whether there are any.
    pub fn search(&mut self, nearby: &NearbyCollider<C, B>, moving: &mut MovingSurface, params: &StepParams) -> bool {
        let near = self.near.entry(nearby.collider);
        let near = near.or_insert_with(|| ColliderParts::new(nearby.body));
        near.seen = self.step;
        self.listed[0].push(nearby.collider);
        // Covers the end positions of all vertices that come near during the step, plus a margin that saves searches in the next
        // steps.
        let room = 3.0 * moving.displacement() as f32 + 0.1 * nearby.bounds.extents().max_element();
        let region = nearby.bounds.loosened(params.prediction + room);
        let travelled = (moving.travelled() - near.travelled) as f32;
        let known = near
            .region
            .contains(&nearby.bounds.loosened(params.prediction + travelled));
        // After a jump, the old region is far too large and contains triangles under other bodies.
        if known && near.region.extents().cmple(2.0 * region.extents()).all() {
            return !near.triangles.is_empty();
        }
        self.searched = true;
        near.search(region, moving, &mut self.buffers.shapes)
    }

    /// The same for the coming step only, on a surface whose own body also moves: finds the triangles within `reach`.
    pub fn search_anew(&mut self, nearby: &NearbyCollider<C, B>, moving: &mut MovingSurface, reach: Real) -> bool {
        let near = self.near.entry(nearby.collider);
        let near = near.or_insert_with(|| ColliderParts::new(nearby.body));
        near.seen = self.step;
        self.listed[0].push(nearby.collider);
        let region = nearby.bounds.loosened(reach + moving.displacement() as f32);
        self.searched = true;
        near.search(region, moving, &mut self.buffers.shapes)
    }

    /// Creates or updates the parts that a collider may touch. Returns how many parts were blended.
    pub fn push(
        &mut self,
        nearby: &NearbyCollider<C, B>,
        moving: &mut MovingSurface,
        params: &StepParams,
        bodies: &mut impl Bodies<P>,
    ) -> u32 {
        let Self {
            near, buffers, layout, ..
        } = self;
        let Some(near) = near.get_mut(&nearby.collider) else {
            return 0;
        };
        buffers.free.clear();
        for &triangle in &near.triangles {
            let taken = &mut buffers.taken[triangle as usize];
            if std::mem::replace(taken, self.step) != self.step {
                buffers.free.push(triangle);
            }
        }
        let cut = near.cut.min(buffers.free.len());
        if cut > 1 {
            buffers
                .free
                .sort_unstable_by_key(|&triangle| layout.order[triangle as usize]);
        }
        let each = buffers.free.len().div_ceil(cut.max(1)).max(1);
        let parts = buffers.free.chunks(each);
        while near.parts.len() > parts.len() {
            near.parts.pop().into_iter().for_each(|part| bodies.remove(part.body));
        }
        near.parts.resize_with(parts.len(), Part::new);

        let target = TargetCollider {
            center: nearby.bounds.center().as_dvec3(),
            size: f64::from(nearby.bounds.extents().max_element()),
        };
        let (mut blended, mut differs) = (0, false);
        let bvh = moving.bvh().clone();
        for (part, triangles) in near.parts.iter_mut().zip(parts) {
            part.take(triangles, bvh.model(), layout, &mut buffers.part);
            if moving.moves || !part.is_settled() {
                blended += 1;
                differs |= part.update(moving, &target, params, bodies, &mut buffers.part);
            }
        }
        if differs && near.cut < MAX_CUT {
            near.cut *= 2;
        }
        if nearby.asleep && !near.is_settled() {
            self.to_wake.push(nearby.body);
        }
        blended
    }

    /// How the surface moves near a collider in the coming step: one motion for each of the collider's parts. Call it after
    /// [`push`](Self::push).
    pub fn grounds(
        &self,
        nearby: &NearbyCollider<C, B>,
        moving: &mut MovingSurface,
        params: &StepParams,
    ) -> Vec<Ground> {
        let near = self.near.get(&nearby.collider).filter(|_| moving.is_in_motion());
        let Some(near) = near.filter(|near| !near.triangles.is_empty()) else {
            return vec![Ground::Still];
        };
        let center = nearby.bounds.center().as_dvec3();
        let ground = |moved: Option<Moved>| moved.map_or(Ground::Still, |moved| moved.ground_at(center, params.dt));
        if near.parts.is_empty() {
            // All triangles are in the parts of other colliders.
            return vec![ground(near.sample(moving))];
        }
        near.parts.iter().map(|part| ground(part.moved())).collect()
    }

    /// Whether the parts near a collider move.
    pub fn moves_near(&self, collider: C) -> bool {
        self.near.get(&collider).is_some_and(|near| !near.is_settled())
    }

    /// Forgets colliders that went away.
    pub fn forget(&mut self, mut remove: impl FnMut(P)) {
        let step = self.step;
        self.near.retain(|_, near| {
            let stays = near.seen == step;
            if !stays {
                near.parts.drain(..).for_each(|part| remove(part.body));
            }
            stays
        });
    }

    /// Sleeping bodies whose ground moves.
    pub fn take_to_wake(&mut self) -> impl Iterator<Item = B> {
        self.to_wake.drain(..)
    }
}
