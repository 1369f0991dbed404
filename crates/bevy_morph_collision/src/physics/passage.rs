//! Keeps fast bodies from passing through a surface.
//!
//! An engine stops a fast body where it would touch a part, but the part then moves on during the rest of the step, and past the
//! middle of a small body. Contacts would push it out on the other side from then on. So after a step, the way of each fast body's
//! middle is compared with the motion of the triangles, exactly: if they met, the body is put back on the side from which it came,
//! where the surface is now. The engine's next contact stops it there.

use bevy::math::{DVec3, Vec3};
use morph_collision::ShapeQuery;
use morph_collision::motion::{MovingPoint, vertex_face_impact};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Pose as Place;
use parry3d::shape::Shape;

use super::follow::Following;
use super::motion::between;

/// A body that moves by less than this in a step, relative to its smallest extent, overlaps a surface so little when it arrives
/// that contacts push it back out.
pub(crate) const FAR: f32 = 0.25;

/// How precise times of contact are, as a fraction of a step.
const PRECISION: f64 = 1e-9;

/// The colliders that may pass through a surface in a step. `C` identifies a collider in the physics engine, and `B` a body.
pub(crate) struct Passage<C, B> {
    fast: Vec<Fast<C, B>>,
    // Scratch memory.
    query: ShapeQuery,
    triangles: Vec<u32>,
    vertices: Vec<u32>,
    now: Vec<DVec3>,
    before: Vec<DVec3>,
    velocities: Vec<DVec3>,
}

/// A collider that moves far, relative to its size.
struct Fast<C, B> {
    collider: C,
    body: B,
    /// Its middle at the start of the step.
    start: DVec3,
    /// Half its smallest extent.
    size: f64,
}

impl<C, B> Default for Passage<C, B> {
    fn default() -> Self {
        Self {
            fast: Vec::new(),
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
pub(crate) fn middle(shape: &dyn Shape) -> Option<Vec3> {
    shape.as_support_map()?;
    Some(shape.compute_local_bounding_sphere().center())
}

/// A convex collider at the start of a step.
#[derive(Clone, Copy)]
pub(crate) struct Flight {
    middle: DVec3,
    /// Its smallest extent.
    thin: f32,
    /// How far any of its points may move in the step.
    travel: f32,
}

impl Flight {
    /// `None` if the shape is not convex.
    pub(crate) fn of(shape: &dyn Shape, place: &Place, travel: f32) -> Option<Self> {
        Some(Self {
            middle: place.transform_point(middle(shape)?).as_dvec3(),
            thin: shape.compute_local_aabb().extents().min_element(),
            travel,
        })
    }
}

impl<C: Copy, B: Copy> Passage<C, B> {
    /// Begins a step.
    pub(crate) fn begin(&mut self) {
        self.fast.clear();
    }

    /// Watches a collider if it or the surface may move farther than contacts can handle.
    pub(crate) fn watch(&mut self, (collider, body): (C, B), flight: &Flight, following: &Following) {
        let &Flight { middle, thin, travel } = flight;
        let comes = if following.is_in_motion() {
            following.displacement as f32
        } else {
            0.0
        };
        if travel + comes > FAR * thin {
            self.fast.push(Fast {
                collider,
                body,
                start: middle,
                size: 0.5 * f64::from(thin),
            });
        }
    }

    /// Ends a step: returns the bodies that have passed through the surface, or into a solid one, and how they must be moved back.
    ///
    /// `end` returns where the middle of a collider is after the step.
    pub(crate) fn hold_back(&mut self, following: &mut Following, end: impl Fn(C) -> Option<Vec3>) -> Vec<(B, Vec3)> {
        let mut fast = std::mem::take(&mut self.fast);
        let shift = |fast: &Fast<C, B>| {
            let end = end(fast.collider)?.as_dvec3();
            let target = self.target(following, MovingPoint::new(fast.start, end), fast.size)?;
            Some((fast.body, (target - end).as_vec3()))
        };
        let shifts = fast.iter().filter_map(shift).collect();
        fast.clear();
        self.fast = fast;
        shifts
    }

    /// Where a point must be that moved on this way; `None` if it may stay.
    fn target(&mut self, following: &mut Following, way: MovingPoint, size: f64) -> Option<DVec3> {
        self.look(following, way);
        let outward = following.surface.lock().outward().map(f64::from);
        let crossing = self.first_crossing(way, outward)?;
        let [at, normal] = crossing.now;
        // As far from the surface as it is when it touches, unless something else is in the way there.
        let clearances = [1.0, 0.25, 0.05].map(|share| at + share * size * normal);
        let is_free = |target: &&DVec3| {
            let way = MovingPoint::new(way.start, **target);
            self.first_crossing(way, outward).is_none()
        };
        let target = clearances.iter().find(is_free).or(clearances.last());
        target.copied().filter(|target| target.is_finite())
    }

    /// Collects the triangles around the way of a point, with their motion.
    fn look(&mut self, following: &mut Following, way: MovingPoint) {
        self.triangles.clear();
        self.vertices.clear();
        self.before.clear();
        self.now.clear();
        let moves = following.is_in_motion();
        let reach = if moves { following.displacement as f32 } else { 0.0 };
        let (min, max) = (way.start.min(way.end).as_vec3(), way.start.max(way.end).as_vec3());
        let around = Aabb::new(min.map(f32::next_down), max.map(f32::next_up)).loosened(reach.next_up());
        if !way.start.is_finite() || !way.end.is_finite() {
            return;
        }
        following.triangles_in(&around, &mut self.query, &mut self.triangles);
        let bvh = following.before.pose.bvh().clone();
        for &triangle in &self.triangles {
            self.vertices
                .extend(bvh.model().triangle(triangle).into_iter().flatten());
        }
        if self.vertices.is_empty() {
            return;
        }
        following.vertices(&self.vertices, &mut self.now);
        if moves {
            following.before.vertices(&self.vertices, &mut self.before);
            between(&self.before, &self.now, following.motion_time(), &mut self.velocities);
            if following.is_motion(&self.vertices, &self.before, &self.velocities) {
                let dt = f64::from(following.last_step());
                for ((before, now), velocity) in self.before.iter_mut().zip(&self.now).zip(&self.velocities) {
                    *before = now - dt * velocity;
                }
                return;
            }
        }
        // A jump passes nothing.
        self.before.clone_from(&self.now);
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

/// Where a point passes through a triangle.
struct Crossing {
    time: f64,
    /// The point of the triangle at the end of the step, and the normal on the side from which the point came.
    now: [DVec3; 2],
}

impl Crossing {
    /// `None` if the point may pass, because it leaves a solid surface, or does not move relative to the triangle.
    fn of(way: MovingPoint, face: [MovingPoint; 3], time: f64, outward: Option<f64>) -> Option<Self> {
        let at = |point: MovingPoint| point.start.lerp(point.end, time);
        let [a, b, c] = face.map(at);
        let point = at(way);
        let normal = (b - a).cross(c - a);
        let square = normal.length_squared();
        let weights = [(b, c), (c, a), (a, b)].map(|(from, to)| (from - point).cross(to - point).dot(normal) / square);
        let blend =
            |points: [DVec3; 3]| -> DVec3 { points.iter().zip(weights).map(|(point, weight)| point * weight).sum() };
        let comes = (way.end - way.start) - blend(face.map(|corner| corner.end - corner.start));
        // The side from which it comes, by the triangle's winding.
        let side = -comes.dot(normal).signum();
        if comes.dot(normal) == 0.0 || outward.is_some_and(|outward| outward != side) {
            return None;
        }
        let [a, b, c] = face.map(|corner| corner.end);
        let normal = (b - a).cross(c - a).try_normalize()? * side;
        let now = [blend([a, b, c]), normal];
        now.iter()
            .all(|vector| vector.is_finite())
            .then_some(Self { time, now })
    }
}

/// Whether the boxes around the ways of a point and a triangle overlap.
fn may_meet(way: MovingPoint, face: [MovingPoint; 3]) -> bool {
    let corners = face.map(|corner| [corner.start, corner.end]);
    let min = corners.as_flattened().iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let max = corners
        .as_flattened()
        .iter()
        .copied()
        .fold(DVec3::NEG_INFINITY, DVec3::max);
    way.start.min(way.end).cmple(max).all() && way.start.max(way.end).cmpge(min).all()
}
