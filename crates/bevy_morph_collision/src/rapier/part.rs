//! A part of a surface as a kinematic body that moves as the surface does there.

use bevy::math::DVec3;
use bevy::prelude::Entity;
use bevy_rapier3d::parry::math::Pose as Place;
use bevy_rapier3d::parry::shape::{SharedShape, Triangle};
use bevy_rapier3d::rapier::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::{ActiveCollisionTypes, ColliderBuilder, ColliderHandle};
use morph_collision::MorphModel;

use super::follow::Following;
use super::layout::{MeshLayout, NONE};
use super::motion::{RigidMotion, continuous, fastest};
use super::triangles::{Patch, Triangles, pseudo_normals};
use super::world::{Manners, Step, World};

/// Some triangles of a surface in the physics world.
pub(super) struct Part {
    body: RigidBodyHandle,
    pub(super) collider: ColliderHandle,
    /// As the mesh numbers them.
    triangles: Vec<u32>,
    vertices: Vec<u32>,
    /// Places among the vertices.
    corners: Vec<[u32; 3]>,
    /// Likewise of neighbours' third corners, or [`NONE`].
    across: Vec<[u32; 3]>,
    /// Whether it consists of other triangles than its shape.
    reshaped: bool,
    /// Whether it stands where the surface is now, and does not move.
    settled: bool,
}

/// What a part is for.
pub(super) struct Purpose {
    pub(super) entity: Entity,
    pub(super) manners: Manners,
    /// The middle of what it is to meet, and how large that is.
    pub(super) center: DVec3,
    pub(super) size: f64,
}

/// Memory that parts use in turn.
#[derive(Default)]
pub(super) struct PartScratch {
    /// For each vertex of the mesh, where it stands among a part's: with the number of the part for which that is so.
    places: Vec<(u32, u32)>,
    part: u32,
    now: Vec<DVec3>,
    before: Vec<DVec3>,
    past: Vec<DVec3>,
    velocities: Vec<DVec3>,
    velocities_before: Vec<DVec3>,
    weights: Vec<f64>,
}

impl Part {
    pub(super) fn new() -> Self {
        Self {
            body: RigidBodyHandle::invalid(),
            collider: ColliderHandle::invalid(),
            triangles: Vec::new(),
            vertices: Vec::new(),
            corners: Vec::new(),
            across: Vec::new(),
            reshaped: true,
            settled: false,
        }
    }

    pub(super) fn is_settled(&self) -> bool {
        self.settled
    }

    pub(super) fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    pub(super) fn remove(&mut self, world: &mut World) {
        world.remove(self.body);
    }

    /// Consists of these triangles from now on.
    pub(super) fn take(
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

    /// Puts the part where the surface is at the begin of the step, moving as the surface does until its end.
    ///
    /// Says whether it moves too differently in different places for one body.
    pub(super) fn update(
        &mut self,
        following: &mut Following,
        purpose: &Purpose,
        step: &Step,
        world: &mut World,
        scratch: &mut PartScratch,
    ) -> bool {
        following.vertices(&self.vertices, &mut scratch.now);
        let moves = following.moves && self.velocities(following, step, scratch);
        let PartScratch {
            now,
            before,
            velocities,
            weights,
            ..
        } = scratch;
        let start = if moves { before } else { now };
        if start.is_empty() || !start.iter().all(|vertex| vertex.as_vec3().is_finite()) {
            // Where no number can say. What was good before stays.
            return false;
        }
        let origin = (start.iter().sum::<DVec3>() / start.len() as f64).as_vec3();
        let (mut motion, mut speed, mut differs) = (RigidMotion::default(), 0.0, false);
        weigh(start, purpose, weights);
        for vertex in start.iter_mut() {
            *vertex -= origin.as_dvec3();
        }
        if moves {
            speed = fastest(velocities);
            motion = RigidMotion::fitted(start, velocities, weights);
            differs = motion.error(start, velocities, weights) > 0.02 * speed;
        }
        self.settled = !following.moves || (moves && speed == 0.0);

        let start: &[DVec3] = start;
        let triangles = self.corners.iter().zip(&self.across).map(|(corners, across)| {
            let corners = corners.map(|corner| start[corner as usize].as_vec3());
            let across = across.map(|corner| start.get(corner as usize).map(|vertex| vertex.as_vec3()));
            (Triangle::from(corners), pseudo_normals(corners, across, None))
        });
        let (linear, angular) = (motion.linear.as_vec3(), motion.angular.as_vec3());
        // Contacts with what it will reach during the step, too.
        let reach = speed as f32 * step.dt;
        let place = Place::from_translation(origin);
        if let Some(body) = world.bodies.get_mut(self.body) {
            body.set_position(place, false);
            body.set_linvel(linear, false);
            body.set_angvel(angular, false);
            body.set_soft_ccd_prediction(reach);
        } else {
            let body = RigidBodyBuilder::kinematic_velocity_based()
                .pose(place)
                .linvel(linear)
                .angvel(angular)
                .soft_ccd_prediction(reach)
                .user_data(u128::from(purpose.entity.to_bits()));
            self.body = world.bodies.insert(body);
        }
        let patch = |(corners, normals): (Vec<_>, Vec<_>)| Patch {
            triangles: Triangles::new(Vec::new(), corners, normals),
            stepping: step.stepping.clone(),
        };
        let reshaped = std::mem::take(&mut self.reshaped);
        let Some(collider) = world.colliders.get_mut(self.collider) else {
            let mut collider = ColliderBuilder::new(SharedShape::new(patch(triangles.unzip())))
                .density(0.0)
                .active_collision_types(ActiveCollisionTypes::DYNAMIC_KINEMATIC)
                .user_data(u128::from(purpose.entity.to_bits()))
                .build();
            purpose.manners.teach(&mut collider);
            self.collider = world.colliders.insert_with_parent(collider, self.body, world.bodies);
            return differs;
        };
        let shape = collider.shape_mut().as_shape_mut::<Patch>();
        match shape.filter(|patch| !reshaped && patch.triangles.len() == self.corners.len()) {
            Some(patch) => patch.triangles.move_to(triangles),
            None => collider.set_shape(SharedShape::new(patch(triangles.unzip()))),
        }
        differs
    }

    /// Finds what velocity each vertex has, and whether that is a motion rather than a jump.
    fn velocities(&self, following: &mut Following, step: &Step, scratch: &mut PartScratch) -> bool {
        let PartScratch {
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

/// What is closest to a body counts most: 1 for the closest vertex, less for those farther away.
fn weigh(vertices: &[DVec3], purpose: &Purpose, weights: &mut Vec<f64>) {
    weights.clear();
    weights.extend(vertices.iter().map(|vertex| vertex.distance_squared(purpose.center)));
    let closest = weights.iter().copied().fold(f64::INFINITY, f64::min);
    let scale = 16.0 / (purpose.size * purpose.size).max(f64::MIN_POSITIVE);
    for weight in weights {
        *weight = 1.0 / (1.0 + scale * (*weight - closest));
    }
}
