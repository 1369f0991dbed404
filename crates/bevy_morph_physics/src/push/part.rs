//! A part of a surface as a kinematic body that moves like the surface.

use bevy::math::{DVec3, Vec3};
use morph_collision::MorphModel;
use parry3d::shape::{Triangle, TrianglePseudoNormals};

use super::moved::Moved;
use crate::math::{RigidMotion, between, fastest, largest};
use crate::moving::MovingSurface;
use crate::shape::{MeshLayout, NONE, pseudo_normals};

/// The parameters of a step.
#[derive(Clone, Copy)]
pub struct StepParams {
    /// In seconds.
    pub dt: f32,
    /// The distance at which contacts are prepared.
    pub prediction: f32,
}

/// Where a part is at the start of a step, and how it moves during the step.
pub struct PartMotion {
    /// Where it is, without rotation.
    pub origin: Vec3,
    /// The velocity of its origin.
    pub linear: Vec3,
    /// Its angular velocity.
    pub angular: Vec3,
    /// The maximum distance that any of its points moves.
    pub reach: f32,
    /// Whether its set of triangles has changed.
    pub reshaped: bool,
}

/// The kinematic bodies that represent parts in a physics engine. `P` identifies one; the default means that there is none yet.
pub trait Bodies<P> {
    /// Adds a part to the world, or moves it. Triangles are relative to its origin, with the normals that contacts may have.
    fn set(
        &mut self,
        part: &mut P,
        part_motion: &PartMotion,
        triangles: impl ExactSizeIterator<Item = (Triangle, Option<TrianglePseudoNormals>)>,
    );

    /// Removes a part.
    fn remove(&mut self, part: P);
}

/// Some triangles of a surface in the physics world.
pub(super) struct Part<P> {
    pub(super) body: P,
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

/// The collider for which a part exists.
pub(super) struct TargetCollider {
    /// The middle and size of the collider.
    pub(super) center: DVec3,
    pub(super) size: f64,
}

/// Scratch memory that parts share.
#[derive(Default)]
pub(super) struct PartBuffers {
    /// For each vertex of the mesh, its index among a part's vertices, and the number of the part for which that is valid.
    slots: Vec<(u32, u32)>,
    part: u32,
    now: Vec<DVec3>,
    before: Vec<DVec3>,
    velocities: Vec<DVec3>,
    weights: Vec<f64>,
}

impl<P: Default> Part<P> {
    pub(super) fn new() -> Self {
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
    pub(super) fn moved(&self) -> Option<Moved> {
        self.moved
    }

    pub(super) fn is_settled(&self) -> bool {
        self.settled
    }

    /// Makes the next update place it again.
    pub(super) fn unsettle(&mut self) {
        self.settled = false;
    }

    pub(super) fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Sets the triangles of the part.
    pub(super) fn take(
        &mut self,
        triangles: &[u32],
        model: &MorphModel,
        layout: &MeshLayout,
        buffers: &mut PartBuffers,
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
        buffers.slots.resize(model.vertex_count(), (0, 0));
        buffers.part += 1;
        let vertices = &mut self.vertices;
        let mut slot_of = |vertex: u32| {
            if vertex == NONE {
                return NONE;
            }
            let slot = &mut buffers.slots[vertex as usize];
            if slot.0 != buffers.part {
                *slot = (buffers.part, vertices.len() as u32);
                vertices.push(vertex);
            }
            slot.1
        };
        for corners in triangles.iter().filter_map(|&triangle| model.triangle(triangle)) {
            self.corners.push(corners.map(&mut slot_of));
        }
        for &triangle in triangles {
            self.across.push(layout.across[triangle as usize].map(&mut slot_of));
        }
    }

    /// Places the part where the surface is at the start of the step, with the motion of the surface until the end of the step.
    ///
    /// Returns whether different places move too differently for one body.
    pub(super) fn update(
        &mut self,
        moving: &mut MovingSurface,
        target: &TargetCollider,
        params: &StepParams,
        bodies: &mut impl Bodies<P>,
        buffers: &mut PartBuffers,
    ) -> bool {
        moving.vertices(&self.vertices, &mut buffers.now);
        let moves = moving.is_in_motion() && self.velocities(moving, params, buffers);
        let PartBuffers {
            now,
            before,
            velocities,
            weights,
            ..
        } = buffers;
        let start = if moves { before } else { now };
        if start.is_empty() || !start.iter().all(|vertex| vertex.as_vec3().is_finite()) {
            // Not finite in `f32`. The last valid state stays.
            return false;
        }
        let origin = (start.iter().sum::<DVec3>() / start.len() as f64).as_vec3();
        let (mut motion, mut speed, mut error) = (RigidMotion::default(), 0.0, 0.0);
        weight_by_distance(start, target, weights);
        for vertex in start.iter_mut() {
            *vertex -= origin.as_dvec3();
        }
        if moves {
            speed = fastest(velocities);
            motion = RigidMotion::fitted(start, velocities, weights);
            error = motion.error(start, velocities, weights);
        }
        self.settled = !moving.moves || (moves && speed == 0.0);
        self.moved = moves.then_some(Moved {
            motion,
            origin: origin.as_dvec3(),
            error,
        });

        let start: &[DVec3] = start;
        let outward = moving.surface.lock().outward();
        let triangles = self.corners.iter().zip(&self.across).map(|(corners, across)| {
            let corners = corners.map(|corner| start[corner as usize].as_vec3());
            let across = across.map(|corner| start.get(corner as usize).map(|vertex| vertex.as_vec3()));
            (Triangle::from(corners), pseudo_normals(corners, across, outward))
        });
        let part_motion = PartMotion {
            origin,
            linear: motion.linear.as_vec3(),
            angular: motion.angular.as_vec3(),
            reach: speed as f32 * params.dt,
            reshaped: std::mem::take(&mut self.reshaped),
        };
        bodies.set(&mut self.body, &part_motion, triangles);
        error > 0.02 * speed
    }

    /// Computes the velocity of each vertex. Returns whether that is a motion and not a jump.
    fn velocities(&self, moving: &mut MovingSurface, params: &StepParams, buffers: &mut PartBuffers) -> bool {
        let PartBuffers {
            now,
            before,
            velocities,
            ..
        } = buffers;
        moving.moments.start.vertices(&self.vertices, before);
        between(before, now, moving.motion_time(), velocities);
        let limit = moving.velocity_limit();
        if moving.looks_between_frames() {
            // A step may cover only a small piece of a jump. A part that moves as before has not jumped.
            let slight = 0.1 * limit;
            return fastest(velocities) <= slight
                || self.moved.is_some_and(|moved| {
                    let changes = before.iter().zip(&*velocities);
                    let changes = changes.map(|(vertex, velocity)| velocity.distance(moved.at(*vertex)));
                    largest(changes) <= slight
                })
                || moving.is_continuous(&self.vertices);
        }
        if !moving.is_motion(&self.vertices, before, velocities) {
            return false;
        }
        if moving.motion_time() > f64::from(params.dt) {
            // Only the last part of the change is motion.
            for ((before, now), velocity) in before.iter_mut().zip(now).zip(velocities) {
                *before = *now - f64::from(params.dt) * *velocity;
            }
        }
        true
    }
}

/// Weights vertices by their distance to a body: 1 for the closest vertex, less for farther ones.
fn weight_by_distance(vertices: &[DVec3], target: &TargetCollider, weights: &mut Vec<f64>) {
    weights.clear();
    weights.extend(vertices.iter().map(|vertex| vertex.distance_squared(target.center)));
    let closest = weights.iter().copied().fold(f64::INFINITY, f64::min);
    let scale = 16.0 / (target.size * target.size).max(f64::MIN_POSITIVE);
    for weight in weights {
        *weight = 1.0 / (1.0 + scale * (*weight - closest));
    }
}
