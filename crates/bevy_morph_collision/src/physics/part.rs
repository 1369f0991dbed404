//! A part of a surface as a kinematic body that moves like the surface.

use bevy::math::{DVec3, Vec3};
use morph_collision::MorphModel;
use parry3d::shape::{Triangle, TrianglePseudoNormals};

use super::follow::Following;
use super::layout::{MeshLayout, NONE};
use super::motion::{RigidMotion, between, fastest, largest};
use super::passage::Ground;
use super::triangles::pseudo_normals;

/// The parameters of a step.
#[derive(Clone, Copy)]
pub(crate) struct Pace {
    /// In seconds.
    pub(crate) dt: f32,
    /// The distance at which contacts are prepared.
    pub(crate) prediction: f32,
}

/// Where a part is at the start of a step, and how it moves during the step.
pub(crate) struct Placed {
    pub(crate) origin: Vec3,
    pub(crate) linear: Vec3,
    pub(crate) angular: Vec3,
    /// The maximum distance that any of its points moves.
    pub(crate) reach: f32,
    /// Whether its set of triangles has changed.
    pub(crate) reshaped: bool,
}

/// The kinematic bodies that represent parts in a physics engine. `P` identifies one; the default means that there is none yet.
pub(crate) trait Bodies<P> {
    /// Adds a part to the world, or moves it. Triangles are relative to its origin, with the normals that contacts may have.
    fn put(
        &mut self,
        part: &mut P,
        placed: &Placed,
        triangles: impl ExactSizeIterator<Item = (Triangle, Option<TrianglePseudoNormals>)>,
    );

    /// Removes a part.
    fn remove(&mut self, part: P);
}

/// Some triangles of a surface in the physics world.
pub(crate) struct Part<P> {
    pub(crate) body: P,
    /// Triangle numbers of the mesh.
    triangles: Vec<u32>,
    vertices: Vec<u32>,
    /// Indices into `vertices`.
    corners: Vec<[u32; 3]>,
    /// The third corners of neighbours, as indices into `vertices`, or [`NONE`].
    across: Vec<[u32; 3]>,
    /// Whether its triangles have changed since its shape was made.
    reshaped: bool,
    /// Whether it is where the surface is now and does not move.
    settled: bool,
    /// Its motion in the last step, if that was not a jump.
    moved: Option<Moved>,
}

/// How a part moves in a step.
#[derive(Clone, Copy)]
pub(crate) struct Moved {
    motion: RigidMotion,
    /// The origin of the motion.
    origin: DVec3,
    /// How much faster its vertices are than that, at most. Vertices far from the collider count less.
    error: f64,
}

impl Moved {
    /// The motion of points at these positions that have these velocities.
    pub(crate) fn fitted(points: &[DVec3], velocities: &[DVec3]) -> Self {
        let origin = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let points: Vec<DVec3> = points.iter().map(|point| *point - origin).collect();
        let weights = vec![1.0; points.len()];
        let motion = RigidMotion::fitted(&points, velocities, &weights);
        Self {
            motion,
            origin,
            error: motion.error(&points, velocities, &weights),
        }
    }

    /// The velocity of a point.
    fn at(&self, point: DVec3) -> DVec3 {
        self.motion.at(point - self.origin)
    }

    /// What it does to a collider whose middle is at `point`, in `dt` seconds.
    pub(crate) fn ground_at(&self, point: DVec3, dt: f32) -> Ground {
        Ground::Moving {
            way: self.at(point).as_vec3() * dt,
            turn: self.motion.angular.as_vec3() * dt,
            error: self.error as f32 * dt,
        }
    }
}

/// The collider for which a part exists.
pub(crate) struct Purpose {
    /// The middle and size of the collider.
    pub(crate) center: DVec3,
    pub(crate) size: f64,
}

/// Scratch memory that parts share.
#[derive(Default)]
pub(crate) struct PartScratch {
    /// For each vertex of the mesh, its index among a part's vertices, and the number of the part for which that is valid.
    places: Vec<(u32, u32)>,
    part: u32,
    now: Vec<DVec3>,
    before: Vec<DVec3>,
    velocities: Vec<DVec3>,
    weights: Vec<f64>,
}

impl<P: Default> Part<P> {
    pub(crate) fn new() -> Self {
        Self {
            body: P::default(),
            triangles: Vec::new(),
            vertices: Vec::new(),
            corners: Vec::new(),
            across: Vec::new(),
            reshaped: true,
            settled: false,
            moved: None,
        }
    }

    /// How it moves in the step, if it does not jump.
    pub(crate) fn moved(&self) -> Option<Moved> {
        self.moved
    }

    pub(crate) fn is_settled(&self) -> bool {
        self.settled
    }

    /// Makes the next update place it again.
    pub(crate) fn unsettle(&mut self) {
        self.settled = false;
    }

    pub(crate) fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Sets the triangles of the part.
    pub(crate) fn take(
        &mut self,
        triangles: &[u32],
        model: &MorphModel,
        layout: &MeshLayout,
        scratch: &mut PartScratch,
    ) {
        if self.triangles == triangles {
            return;
        }
        self.settled = false;
        self.reshaped = true;
        self.triangles.clear();
        self.triangles.extend_from_slice(triangles);
        self.vertices.clear();
        self.corners.clear();
        self.across.clear();
        scratch.places.resize(model.vertex_count(), (0, 0));
        scratch.part += 1;
        let vertices = &mut self.vertices;
        let mut place_of = |vertex: u32| {
            if vertex == NONE {
                return NONE;
            }
            let place = &mut scratch.places[vertex as usize];
            if place.0 != scratch.part {
                *place = (scratch.part, vertices.len() as u32);
                vertices.push(vertex);
            }
            place.1
        };
        for corners in triangles.iter().filter_map(|&triangle| model.triangle(triangle)) {
            self.corners.push(corners.map(&mut place_of));
        }
        for &triangle in triangles {
            self.across.push(layout.across[triangle as usize].map(&mut place_of));
        }
    }

    /// Places the part where the surface is at the start of the step, with the motion of the surface until the end of the step.
    ///
    /// Returns whether different places move too differently for one body.
    pub(crate) fn update(
        &mut self,
        following: &mut Following,
        purpose: &Purpose,
        pace: &Pace,
        bodies: &mut impl Bodies<P>,
        scratch: &mut PartScratch,
    ) -> bool {
        following.vertices(&self.vertices, &mut scratch.now);
        let moves = following.is_in_motion() && self.velocities(following, pace, scratch);
        let PartScratch {
            now,
            before,
            velocities,
            weights,
            ..
        } = scratch;
        let start = if moves { before } else { now };
        if start.is_empty() || !start.iter().all(|vertex| vertex.as_vec3().is_finite()) {
            // Not finite in `f32`. The last valid state stays.
            return false;
        }
        let origin = (start.iter().sum::<DVec3>() / start.len() as f64).as_vec3();
        let (mut motion, mut speed, mut error) = (RigidMotion::default(), 0.0, 0.0);
        weigh(start, purpose, weights);
        for vertex in start.iter_mut() {
            *vertex -= origin.as_dvec3();
        }
        if moves {
            speed = fastest(velocities);
            motion = RigidMotion::fitted(start, velocities, weights);
            error = motion.error(start, velocities, weights);
        }
        self.settled = !following.moves || (moves && speed == 0.0);
        self.moved = moves.then_some(Moved {
            motion,
            origin: origin.as_dvec3(),
            error,
        });

        let start: &[DVec3] = start;
        let outward = following.surface.lock().outward();
        let triangles = self.corners.iter().zip(&self.across).map(|(corners, across)| {
            let corners = corners.map(|corner| start[corner as usize].as_vec3());
            let across = across.map(|corner| start.get(corner as usize).map(|vertex| vertex.as_vec3()));
            (Triangle::from(corners), pseudo_normals(corners, across, outward))
        });
        let placed = Placed {
            origin,
            linear: motion.linear.as_vec3(),
            angular: motion.angular.as_vec3(),
            reach: speed as f32 * pace.dt,
            reshaped: std::mem::take(&mut self.reshaped),
        };
        bodies.put(&mut self.body, &placed, triangles);
        error > 0.02 * speed
    }

    /// Computes the velocity of each vertex. Returns whether that is a motion and not a jump.
    fn velocities(&self, following: &mut Following, pace: &Pace, scratch: &mut PartScratch) -> bool {
        let PartScratch {
            now,
            before,
            velocities,
            ..
        } = scratch;
        following.before.vertices(&self.vertices, before);
        between(before, now, following.motion_time(), velocities);
        let limit = following.velocity_limit();
        if following.looks_between_frames() {
            // A step may cover only a small piece of a jump. A part that moves as before has not jumped.
            let slight = 0.1 * limit;
            return fastest(velocities) <= slight
                || self.moved.is_some_and(|moved| {
                    let changes = before.iter().zip(&*velocities);
                    let changes = changes.map(|(vertex, velocity)| velocity.distance(moved.at(*vertex)));
                    largest(changes) <= slight
                })
                || following.goes_on(&self.vertices);
        }
        if !following.is_motion(&self.vertices, before, velocities) {
            return false;
        }
        if following.motion_time() > f64::from(pace.dt) {
            // Only the last part of the change is motion.
            for ((before, now), velocity) in before.iter_mut().zip(now).zip(velocities) {
                *before = *now - f64::from(pace.dt) * *velocity;
            }
        }
        true
    }
}

/// Weights vertices by their distance to a body: 1 for the closest vertex, less for farther ones.
fn weigh(vertices: &[DVec3], purpose: &Purpose, weights: &mut Vec<f64>) {
    weights.clear();
    weights.extend(vertices.iter().map(|vertex| vertex.distance_squared(purpose.center)));
    let closest = weights.iter().copied().fold(f64::INFINITY, f64::min);
    let scale = 16.0 / (purpose.size * purpose.size).max(f64::MIN_POSITIVE);
    for weight in weights {
        *weight = 1.0 / (1.0 + scale * (*weight - closest));
    }
}
