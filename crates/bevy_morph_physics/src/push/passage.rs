//! Keeps fast bodies from passing through a surface.
//!
//! An engine stops a fast body where it would touch a part, but the part then moves on during the rest of the step, and past the
//! middle of a small body. Contacts would push it out on the other side from then on. So after a step, the way of each fast body's
//! middle is compared with the motion of the triangles, exactly: if they met, the body is put back on the side from which it came,
//! where the surface is now. The engine's next contact stops it there.

use std::hash::Hash;

use bevy::math::{DVec3, Vec3};
use bevy::platform::collections::HashMap;
use morph_collision::ShapeQuery;
use morph_collision::motion::{MovingPoint, vertex_face_impact};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::shape::Shape;

use super::crossing::{Crossing, may_meet};
use super::flight::{FAST, Flight, Ground};
use crate::math::between;
use crate::moving::MovingSurface;

/// How precise times of contact are, as a fraction of a step.
const PRECISION: f64 = 1e-9;

/// The number of triangles with which the bodies of all surfaces are compared in a step. A triangle counts once for each body.
const MAX_TRIANGLES: usize = 200_000;

/// How much work a step may still do, and what it did. What is over the budget is left to the engine.
pub struct Budget {
    triangles: usize,
    /// The number of bodies that were compared with triangles.
    pub compared: u32,
    /// The number of bodies that were not compared, because the budget was used up.
    pub limited: u32,
}

impl Default for Budget {
    fn default() -> Self {
        Self {
            triangles: MAX_TRIANGLES,
            compared: 0,
            limited: 0,
        }
    }
}

impl Budget {
    /// Takes a body's triangles out of the budget. Returns whether there was enough left.
    fn take(&mut self, triangles: usize) -> bool {
        let fits = triangles <= self.triangles;
        self.triangles = self.triangles.saturating_sub(triangles);
        self.limited += u32::from(!fits);
        self.compared += u32::from(fits && triangles > 0);
        fits
    }
}

/// The colliders that may pass through a surface in a step. `C` identifies a collider in the physics engine, and `B` a body.
pub struct Passage<C, B> {
    fast: Vec<FastCollider<C, B>>,
    /// Positions of vertices at the end and at the start of the step, computed once for all bodies.
    posed: HashMap<u32, [DVec3; 2]>,
    // Scratch memory.
    query: ShapeQuery,
    triangles: Vec<u32>,
    vertices: Vec<u32>,
    now: Vec<DVec3>,
    before: Vec<DVec3>,
    velocities: Vec<DVec3>,
}

/// A collider that moves far, relative to its size.
struct FastCollider<C, B> {
    collider: C,
    body: B,
    /// Its middle at the start of the step.
    start: DVec3,
    /// Half its smallest extent.
    size: f64,
    /// Whether the surface near it moves, and no part of that jumps.
    moves: bool,
}

impl<C, B> Default for Passage<C, B> {
    fn default() -> Self {
        Self {
            fast: Vec::new(),
            posed: HashMap::default(),
            query: ShapeQuery::default(),
            triangles: Vec::new(),
            vertices: Vec::new(),
            now: Vec::new(),
            before: Vec::new(),
            velocities: Vec::new(),
        }
    }
}

/// The middle of a convex shape, in its own space. `None` for other shapes: a moving mesh has no thickness, and its middle may be
/// far from it.
pub fn middle(shape: &dyn Shape) -> Option<Vec3> {
    shape.as_support_map()?;
    Some(shape.compute_local_bounding_sphere().center())
}

impl<C: Copy, B: Copy + Eq + Hash> Passage<C, B> {
    /// Begins a step.
    pub fn begin(&mut self) {
        self.fast.clear();
        self.posed.clear();
    }

    /// Watches a collider if it moves farther, relative to the surface, than contacts can handle. Colliders that are not convex
    /// are left to the engine.
    pub fn watch(&mut self, collider: C, body: B, shape: &dyn Shape, flight: &Flight, grounds: &[Ground]) {
        let travel = grounds
            .iter()
            .map(|ground| flight.relative_to(ground))
            .fold(0.0, f32::max);
        if travel == 0.0 {
            return;
        }
        let thin = shape.compute_local_aabb().extents().min_element();
        if travel > FAST * thin
            && let Some(middle) = middle(shape)
        {
            self.fast.push(FastCollider {
                collider,
                body,
                start: flight.isometry.transform_point(middle).as_dvec3(),
                size: 0.5 * f64::from(thin),
                moves: grounds.iter().all(|ground| *ground != Ground::Still),
            });
        }
    }

    /// Ends a step: returns the bodies that have passed through the surface, or into a solid one, and how they must be moved back.
    ///
    /// `end` returns where the middle of a collider is after the step, and `is_blocked` whether something static or kinematic is
    /// between two points. A body is not put behind that, such as the floor on which it lies.
    pub fn move_back(
        &mut self,
        moving: &mut MovingSurface,
        budget: &mut Budget,
        end: impl Fn(C) -> Option<Vec3>,
        is_blocked: impl Fn(C, Vec3, Vec3) -> bool,
    ) -> HashMap<B, Vec3> {
        let mut fast = std::mem::take(&mut self.fast);
        let mut shifts: HashMap<B, Vec3> = HashMap::default();
        for fast in fast.drain(..) {
            let Some(end) = end(fast.collider).map(Vec3::as_dvec3) else {
                continue;
            };
            let is_blocked = |target: DVec3| is_blocked(fast.collider, fast.start.as_vec3(), target.as_vec3());
            let Some(target) = self.target(moving, budget, &fast, end, is_blocked) else {
                continue;
            };
            // A body may have several colliders.
            let (shift, new) = (shifts.entry(fast.body).or_default(), (target - end).as_vec3());
            if new.length() > shift.length() {
                *shift = new;
            }
        }
        self.fast = fast;
        shifts
    }

    /// Where the middle of a collider must be that is at `end`; `None` if it may stay.
    fn target(
        &mut self,
        moving: &mut MovingSurface,
        budget: &mut Budget,
        fast: &FastCollider<C, B>,
        end: DVec3,
        is_blocked: impl Fn(DVec3) -> bool,
    ) -> Option<DVec3> {
        let way = MovingPoint::new(fast.start, end);
        if !self.collect_triangles(moving, budget, way, fast) {
            return None;
        }
        let outward = moving.surface.lock().outward().map(f64::from);
        let crossing = self.first_crossing(way, outward)?;
        let [at, normal] = crossing.now;
        // As far from the surface as it is when it touches, unless something else is in the way there.
        let clearances = [1.0, 0.25, 0.05].map(|share| at + share * fast.size * normal);
        let mut open = clearances
            .into_iter()
            .filter(|target| target.is_finite() && !is_blocked(*target));
        let is_free = |target: &DVec3| {
            let way = MovingPoint::new(way.start, *target);
            self.first_crossing(way, outward).is_none()
        };
        let mut last = None;
        open.find(|target| {
            last = Some(*target);
            is_free(target)
        })
        .or(last)
    }

    /// Collects the triangles around the way of a point, with their motion. Returns whether the budget suffices.
    fn collect_triangles(
        &mut self,
        moving: &mut MovingSurface,
        budget: &mut Budget,
        way: MovingPoint,
        fast: &FastCollider<C, B>,
    ) -> bool {
        self.triangles.clear();
        self.before.clear();
        self.now.clear();
        if !way.start.is_finite() || !way.end.is_finite() {
            return false;
        }
        let reach = if fast.moves { moving.displacement() } else { 0.0 };
        let (min, max) = (way.start.min(way.end).as_vec3(), way.start.max(way.end).as_vec3());
        let surroundings = Aabb::new(min.map(f32::next_down), max.map(f32::next_up));
        let surroundings = surroundings.loosened(((reach + fast.size) as f32).next_up());
        if budget.triangles > 0 {
            moving.triangles_in(&surroundings, &mut self.query, &mut self.triangles);
        }
        if !budget.take(self.triangles.len().max(usize::from(budget.triangles == 0))) {
            return false;
        }
        self.blend(moving);
        let bvh = moving.bvh().clone();
        let corners = self
            .triangles
            .iter()
            .filter_map(|&triangle| bvh.model().triangle(triangle));
        for [now, before] in corners.flatten().map(|vertex| self.posed[&vertex]) {
            self.now.push(now);
            // A jump passes nothing.
            self.before.push(if fast.moves { before } else { now });
        }
        true
    }

    /// Computes the positions of vertices that no body needed so far.
    fn blend(&mut self, moving: &mut MovingSurface) {
        self.vertices.clear();
        let bvh = moving.bvh().clone();
        for &triangle in &self.triangles {
            let corners = bvh.model().triangle(triangle).into_iter().flatten();
            self.vertices
                .extend(corners.filter(|vertex| !self.posed.contains_key(vertex)));
        }
        self.vertices.sort_unstable();
        self.vertices.dedup();
        if self.vertices.is_empty() {
            return;
        }
        moving.vertices(&self.vertices, &mut self.now);
        if moving.is_in_motion() {
            moving.moments.start.vertices(&self.vertices, &mut self.before);
            between(&self.before, &self.now, moving.motion_time(), &mut self.velocities);
            let dt = f64::from(moving.last_step());
            for ((before, now), velocity) in self.before.iter_mut().zip(&self.now).zip(&self.velocities) {
                *before = now - dt * velocity;
            }
        } else {
            self.before.clone_from(&self.now);
        }
        let positions = self.now.drain(..).zip(self.before.drain(..));
        self.posed.extend(
            self.vertices
                .iter()
                .copied()
                .zip(positions.map(|(now, before)| [now, before])),
        );
    }

    /// Where a moving point first passes through a triangle, or into a solid surface.
    fn first_crossing(&self, way: MovingPoint, outward: Option<f64>) -> Option<Crossing> {
        let faces = self.before.chunks_exact(3).zip(self.now.chunks_exact(3));
        let crossings = faces.filter_map(|(before, now)| {
            let face = [0, 1, 2].map(|corner| MovingPoint::new(before[corner], now[corner]));
            if !may_meet(way, face) {
                return None;
            }
            let time = vertex_face_impact(way, face, PRECISION)?.earliest;
            // What starts on the surface is on no side.
            if time > 0.0 {
                Crossing::of(way, face, time, outward)
            } else {
                None
            }
        });
        crossings.min_by(|a, b| a.time.total_cmp(&b.time))
    }
}
