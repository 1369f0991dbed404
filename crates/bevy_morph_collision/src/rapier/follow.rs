//! Where a surface is and was: the end of the step to come, of the last one, and of the one before.

use std::sync::Arc;

use bevy::math::{Affine3A, DVec3};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_rapier3d::parry::bounding_volume::Aabb as ParryAabb;
use bevy_rapier3d::parry::math::Pose as Place;
use bevy_rapier3d::rapier::dynamics::{RigidBodySet, RigidBodyType};
use bevy_rapier3d::rapier::geometry::Collider as RapierCollider;
use morph_collision::{Aabb, Body, InputError, JointMatrices, MorphBvh, Pose, ShapeQuery, WorldFromModel};

use super::layout::MeshLayout;
use super::placed::{corners, joints_in, region, world_bounds};
use super::surface::MorphSurface;
use crate::weights::take_weights;

/// A mesh at one moment.
pub(super) struct Moment {
    pub(super) pose: Pose,
    pub(super) world_from_model: WorldFromModel,
}

impl Moment {
    /// Vertices in world space.
    pub(super) fn vertices(&mut self, vertices: &[u32], into: &mut Vec<DVec3>) {
        posed_vertices(&mut self.pose, &self.world_from_model, vertices, into);
    }
}

fn posed_vertices(pose: &mut Pose, place: &WorldFromModel, vertices: &[u32], into: &mut Vec<DVec3>) {
    into.clear();
    let vertices = vertices.iter().filter_map(|&vertex| pose.vertex(vertex));
    into.extend(vertices.map(|vertex| place.transform_point(vertex)));
}

/// A surface's last moments. What is now is in the [`MorphSurface`] that Rapier has.
pub(super) struct Following {
    pub(super) surface: MorphSurface,
    /// Where it is at the end of the step to come.
    pub(super) world_from_model: WorldFromModel,
    /// Where it was one step earlier, if it moves; otherwise anything.
    pub(super) before: Moment,
    /// Where it was two steps earlier, if it moved then, too; otherwise anything.
    pub(super) past: Moment,
    /// Whether it moves during the step to come.
    pub(super) moves: bool,
    /// Whether it is another shape than before, as its collider sees it.
    pub(super) reshaped: bool,
    /// The length of the last step if it moved during it.
    pub(super) moved_for: Option<f32>,
    /// How far any vertex may be, at the end of the step to come, from where it was at its begin; in world units.
    pub(super) displacement: f64,
    /// All of these so far.
    pub(super) travelled: f64,
    last_step: f32,
    /// Whether it is skinned and has had no joints yet.
    lacks_joints: bool,
    rest: Vec<f32>,
    complaint: Option<String>,
}

impl Following {
    /// At rest for now; where it is, the first step will tell.
    pub(super) fn new(entity: Entity, bvh: &Arc<MorphBvh>, weights: &[f32], layout: &Arc<MeshLayout>) -> Self {
        let moment = || {
            let mut pose = Pose::new(bvh.clone());
            // They are those of a pose of the same tree.
            let _fits = pose.set_weights(weights);
            pose
        };
        let still = |pose| Moment {
            pose,
            world_from_model: WorldFromModel::IDENTITY,
        };
        Self {
            surface: MorphSurface::new(entity, moment(), WorldFromModel::IDENTITY, layout.clone()),
            world_from_model: WorldFromModel::IDENTITY,
            before: still(moment()),
            past: still(moment()),
            moves: false,
            reshaped: true,
            moved_for: None,
            displacement: 0.0,
            travelled: 0.0,
            last_step: 0.0,
            lacks_joints: bvh.model().joint_count().is_some(),
            rest: Vec::new(),
            complaint: None,
        }
    }

    /// Whether joints move the mesh.
    pub(super) fn is_skinned(&self) -> bool {
        self.before.pose.joints().is_some()
    }

    /// Whether it is nowhere, because its joints are.
    pub(super) fn lacks_joints(&self) -> bool {
        self.lacks_joints
    }

    /// Makes the next step the first: whatever changes until then is not a motion.
    pub(super) fn restart(&mut self) {
        self.last_step = 0.0;
        self.moves = false;
    }

    /// Goes on to the end of a step of `dt` seconds. Returns what is wrong with weights that cannot be used, once; the last good ones
    /// stay in force.
    pub(super) fn advance(
        &mut self,
        weights: Option<&MeshMorphWeights>,
        shared: &Query<&MorphWeights>,
        ahead: Ahead,
        dt: f32,
    ) -> Result<(), String> {
        let Ahead {
            world_from_model,
            collider_from_model,
            joints,
        } = ahead;
        let first = self.last_step == 0.0 || (self.lacks_joints && joints.is_some());
        self.lacks_joints &= joints.is_none();
        self.moved_for = self.moves.then_some(self.last_step);
        self.last_step = dt;
        self.moves = false;
        self.reshaped = first;
        self.displacement = 0.0;
        let mut posed = self.surface.lock();
        // The oldest pose is used again for the newest.
        let taken = take_weights(&mut self.past.pose, weights, shared, &mut self.rest);
        if taken.is_err() {
            let _fits = self.past.pose.set_weights(posed.pose.weights());
        }
        // A wrong number of weights is the collider's to report, once it is clear that it will stay.
        let complaint = taken.err().filter(|problem| !problem.is_count());
        let complaint = complaint.map(|problem| problem.to_string());
        // Likewise joints, which the collider reports if they are bad.
        let joints = joints.filter(|joints| self.past.pose.set_joints(joints).is_ok());
        if let (None, Some(last)) = (joints, posed.pose.joints()) {
            let _fits = self.past.pose.set_joints(last);
        }
        let mut same_shape = self.past.pose.weights() == posed.pose.weights();
        if same_shape && self.past.pose.joints() != posed.pose.joints() {
            // Rounding left by removing the collider's place is not a change.
            let size = coordinates(&mut posed.pose, &world_from_model);
            same_shape =
                !first && size.is_finite() && self.past.pose.displacement_from_pose(&mut posed.pose) <= 1e-6 * size;
        }
        if first && self.past.pose.joints().is_some() {
            // It has been seen in the pose that it was bound in.
            posed.forget_mass();
        }
        if !same_shape || world_from_model != self.world_from_model {
            self.moves = !first;
            self.reshaped |= !same_shape;
            std::mem::swap(&mut self.past, &mut self.before);
            // `before` is the new moment now, and the last one changes places with it.
            std::mem::swap(&mut self.before.pose, &mut posed.pose);
            self.before.world_from_model = self.world_from_model;
            self.world_from_model = world_from_model;
            if self.moves {
                self.displacement = displacement(&mut self.before, &posed.pose, &world_from_model);
                self.travelled += self.displacement;
            }
        }
        self.reshaped |= posed.place(collider_from_model);
        drop(posed);
        if self.complaint == complaint {
            return Ok(());
        }
        self.complaint = complaint;
        self.complaint.clone().map_or(Ok(()), Err)
    }

    /// A box around the surface during the step to come.
    pub(super) fn bounds(&mut self) -> Aabb {
        let now = world_bounds(&mut self.surface.lock().pose, &self.world_from_model);
        if !self.moves {
            return now;
        }
        let Moment { pose, world_from_model } = &mut self.before;
        now.union(&world_bounds(pose, world_from_model))
    }

    /// Appends the triangles that meet a box in world space at the end of the step to come.
    pub(super) fn triangles_in(&mut self, bounds: &ParryAabb, query: &mut ShapeQuery, into: &mut Vec<u32>) {
        let mut posed = self.surface.lock();
        if let Ok(region) = region(bounds, &posed.pose, &self.world_from_model) {
            let body = Body::new(&mut posed.pose, &self.world_from_model);
            query.all_in_region(body, &region, into);
        }
    }

    /// Vertices in world space at the end of the step to come.
    pub(super) fn vertices(&mut self, vertices: &[u32], into: &mut Vec<DVec3>) {
        posed_vertices(&mut self.surface.lock().pose, &self.world_from_model, vertices, into);
    }
}

/// How far any vertex may be from where it was, in world units.
fn displacement(before: &mut Moment, pose: &Pose, world_from_model: &WorldFromModel) -> f64 {
    let zero = world_from_model.transform_point(Vec3::ZERO);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| world_from_model.transform_point(axis) - zero);
    let stretch = axes.iter().map(|axis| axis.length_squared()).sum::<f64>().sqrt();
    let reshaped = stretch * pose.displacement_from_pose(&mut before.pose);
    if before.world_from_model == *world_from_model {
        return reshaped;
    }
    // In a box, what an affine map moves farthest is a corner.
    let bounds = before.pose.broad_phase_bounds(&WorldFromModel::IDENTITY);
    let ways = corners(&bounds).map(|corner| {
        let from = before.world_from_model.transform_point(corner);
        from.distance(world_from_model.transform_point(corner))
    });
    reshaped + ways.into_iter().fold(0.0, f64::max)
}

/// The largest coordinate that takes part in where a skinned mesh is.
fn coordinates(pose: &mut Pose, place: &WorldFromModel) -> f64 {
    let bounds = pose.broad_phase_bounds(&WorldFromModel::IDENTITY);
    let own = bounds.min.abs().max(bounds.max.abs()).max_element();
    f64::from(own) + place.transform_point(Vec3::ZERO).abs().max_element()
}

/// The place of an entity without its scale and shear. The rotation of an entity scaled to zero is the identity.
pub(super) fn rigid_place(entity: &GlobalTransform) -> Place {
    let (_, rotation, translation) = entity.to_scale_rotation_translation();
    let place = Place::from_parts(translation, rotation);
    if is_rigid(&place) {
        place
    } else {
        Place::from_parts(translation, Quat::IDENTITY)
    }
}

/// Whether a place is finite and rotates without scaling.
pub(super) fn is_rigid(place: &Place) -> bool {
    // Of a rotation that is not finite, this is false, too.
    place.translation.is_finite() && (place.rotation.length_squared() - 1.0).abs() < 1e-3
}

/// Where a mesh will be at the end of a step.
pub(super) struct Ahead {
    /// From the space of its pose, which for a skinned mesh is the collider's.
    pub(super) world_from_model: WorldFromModel,
    pub(super) collider_from_model: WorldFromModel,
    /// As the collider sees them.
    pub(super) joints: Option<JointMatrices>,
}

impl Ahead {
    /// `joints` are those of a skinned mesh as they are drawn, if they are known.
    pub(super) fn of(
        collider: &RapierCollider,
        bodies: &RigidBodySet,
        entity: &GlobalTransform,
        (is_skinned, joints): (bool, Option<&[Affine3A]>),
        dt: f32,
    ) -> Result<Self, InputError> {
        // Rapier's collider has the entity's place and rotation; what is left is scale and shear, which joints do without.
        let place = rigid_place(entity);
        let rigid = Affine3A::from_rotation_translation(place.rotation, place.translation);
        let affine = if is_skinned { rigid } else { entity.affine() };
        let collider_from_model = if is_skinned {
            Affine3A::IDENTITY
        } else {
            rigid.inverse() * affine
        };
        let joints = joints.map(|joints| joints_in(&place, joints)).transpose()?;
        let ahead = |world_from_model| {
            Ok(Self {
                world_from_model,
                collider_from_model: WorldFromModel::new(collider_from_model)?,
                joints,
            })
        };
        let in_body = collider.position_wrt_parent().copied();
        let body = collider.parent().and_then(|body| bodies.get(body)).zip(in_body);
        let Some((body, in_body)) = body else {
            // As the entity stands, to the last bit: that is where it is drawn.
            return ahead(WorldFromModel::new(affine)?);
        };
        let place: Place = match body.body_type() {
            // Rapier moves it, and nothing else asks.
            RigidBodyType::Dynamic => return ahead(WorldFromModel::IDENTITY),
            RigidBodyType::KinematicPositionBased => *body.next_position(),
            RigidBodyType::KinematicVelocityBased => body.predict_position_using_velocity(dt),
            _ => *body.position(),
        } * in_body;
        let world_from_collider = Affine3A::from_rotation_translation(place.rotation, place.translation);
        ahead(WorldFromModel::new(world_from_collider * collider_from_model)?)
    }
}
