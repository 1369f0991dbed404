//! A mesh at its last few moments, and how far one is from another.

use std::sync::Arc;

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::{MorphBvh, Pose, WorldFromModel};

use crate::math::{corners, largest};
use crate::posing::LazyPose;
use crate::shape::Posed;
use crate::time::DrawnHistory;

/// A mesh at one moment.
pub struct Moment {
    /// The shape.
    pub pose: LazyPose,
    /// Where it is.
    pub world_from_model: WorldFromModel,
}

impl Moment {
    /// Sets the moment to what was drawn at some time, for values that frames change.
    pub(super) fn set_from_history(&mut self, drawn: &DrawnHistory, time: f64) {
        if let Some(weights) = drawn.weights.at(time) {
            let _fits = self.pose.set_weights(&weights);
        }
        if let Some(joints) = drawn.joints.at(time) {
            self.pose.set_joints(&joints);
        }
        let transform = drawn.transform.at(time).filter(|_| drawn.stands_alone);
        if let Some(Ok(world_from_model)) = transform.map(WorldFromModel::new) {
            self.world_from_model = world_from_model;
        }
    }

    /// The positions of vertices in world space.
    pub fn vertices(&mut self, vertices: &[u32], into: &mut Vec<DVec3>) {
        posed_vertices(self.pose.get(), &self.world_from_model, vertices, into);
    }
}

/// The last three moments of a surface: a ring in which the oldest pose becomes the next one.
///
/// The newest pose is in the surface's [`Posed`], which the engine shares. It changes only if the surface moves in a step, so all three
/// differ from each other.
pub struct Moments {
    /// Where the newest pose is, at the end of the coming step.
    pub end: WorldFromModel,
    /// One step earlier. Valid only if the surface moves in the coming step.
    pub start: Moment,
    /// Two steps earlier. Valid only if it also moved in the last step.
    pub earlier: Moment,
}

impl Moments {
    /// All at rest.
    pub(super) fn new(bvh: &Arc<MorphBvh>, weights: &[f32]) -> Self {
        let moment = || Moment {
            pose: pose(bvh, weights),
            world_from_model: WorldFromModel::IDENTITY,
        };
        Self {
            end: WorldFromModel::IDENTITY,
            start: moment(),
            earlier: moment(),
        }
    }

    /// The pose to be set to the next moment: the oldest one, which nobody needs any more.
    pub(super) fn next(&mut self) -> &mut LazyPose {
        &mut self.earlier.pose
    }

    /// Makes [`next`](Self::next) the newest pose, and each other one a step older.
    pub(super) fn advance(&mut self, posed: &mut Posed, world_from_model: WorldFromModel) {
        std::mem::swap(&mut self.earlier, &mut self.start);
        std::mem::swap(&mut self.start.pose, &mut posed.pose);
        self.start.world_from_model = std::mem::replace(&mut self.end, world_from_model);
    }
}

/// A pose of a tree with weights that come from a pose of the same tree.
pub(super) fn pose(bvh: &Arc<MorphBvh>, weights: &[f32]) -> LazyPose {
    let mut pose = Pose::new(bvh.clone());
    let _fits = pose.set_weights(weights);
    LazyPose::new(pose)
}

/// Replaces a list by the positions of vertices in world space.
pub(super) fn posed_vertices(
    pose: &mut Pose,
    world_from_model: &WorldFromModel,
    vertices: &[u32],
    into: &mut Vec<DVec3>,
) {
    into.clear();
    let vertices = vertices.iter().filter_map(|&vertex| pose.vertex(vertex));
    into.extend(vertices.map(|vertex| world_from_model.transform_point(vertex)));
}

/// The maximum distance of any vertex from its earlier position, in world units.
pub(super) fn displacement(before: &mut Moment, pose: &Pose, world_from_model: &WorldFromModel) -> f64 {
    let reshaped = stretch(world_from_model) * pose.displacement_from_pose(before.pose.get());
    if before.world_from_model == *world_from_model {
        return reshaped;
    }
    // In a box, a corner moves farthest under an affine map.
    let bounds = before.pose.get().broad_phase_bounds(&WorldFromModel::IDENTITY);
    let ways = corners(&bounds).map(|corner| {
        let from = before.world_from_model.transform_point(corner);
        from.distance(world_from_model.transform_point(corner))
    });
    reshaped + largest(ways)
}

/// The maximum factor by which a transform lengthens a distance.
fn stretch(world_from_model: &WorldFromModel) -> f64 {
    let zero = world_from_model.transform_point(Vec3::ZERO);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| world_from_model.transform_point(axis) - zero);
    axes.iter().map(|axis| axis.length_squared()).sum::<f64>().sqrt()
}

/// The largest coordinate involved in placing a skinned mesh.
pub(super) fn coordinates(pose: &mut Pose, world_from_model: &WorldFromModel) -> f64 {
    let bounds = pose.broad_phase_bounds(&WorldFromModel::IDENTITY);
    let own = bounds.min.abs().max(bounds.max.abs()).max_element();
    f64::from(own) + world_from_model.transform_point(Vec3::ZERO).abs().max_element()
}
