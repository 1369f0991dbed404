//! A mesh at one moment, and how far it is from another.

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::{JointMatrices, Pose, WorldFromModel};

use super::drawn::Drawn;
use super::motion::largest;
use super::placed::corners;

/// A mesh at one moment.
pub(crate) struct Moment {
    pub(crate) pose: Pose,
    pub(crate) world_from_model: WorldFromModel,
}

impl Moment {
    /// Sets the moment to what was drawn at some time, for values that frames change.
    pub(super) fn see(&mut self, drawn: &Drawn, time: f64) {
        if let Some(weights) = drawn.weights.at(time) {
            let _fits = self.pose.set_weights(&weights);
        }
        if let Some(joints) = drawn.joints.at(time)
            && let Ok(joints) = JointMatrices::new(&joints.matrices)
        {
            let _fits = self.pose.set_joints(&joints);
        }
        let place = drawn.place.at(time).filter(|_| drawn.stands_alone);
        if let Some(Ok(place)) = place.map(WorldFromModel::new) {
            self.world_from_model = place;
        }
    }

    /// The positions of vertices in world space.
    pub(crate) fn vertices(&mut self, vertices: &[u32], into: &mut Vec<DVec3>) {
        posed_vertices(&mut self.pose, &self.world_from_model, vertices, into);
    }
}

/// Replaces a list by the positions of vertices in world space.
pub(super) fn posed_vertices(pose: &mut Pose, place: &WorldFromModel, vertices: &[u32], into: &mut Vec<DVec3>) {
    into.clear();
    let vertices = vertices.iter().filter_map(|&vertex| pose.vertex(vertex));
    into.extend(vertices.map(|vertex| place.transform_point(vertex)));
}

/// The maximum distance of any vertex from its earlier position, in world units.
pub(super) fn displacement(before: &mut Moment, pose: &Pose, world_from_model: &WorldFromModel) -> f64 {
    let reshaped = stretch(world_from_model) * pose.displacement_from_pose(&mut before.pose);
    if before.world_from_model == *world_from_model {
        return reshaped;
    }
    // In a box, a corner moves farthest under an affine map.
    let bounds = before.pose.broad_phase_bounds(&WorldFromModel::IDENTITY);
    let ways = corners(&bounds).map(|corner| {
        let from = before.world_from_model.transform_point(corner);
        from.distance(world_from_model.transform_point(corner))
    });
    reshaped + largest(ways)
}

/// The maximum factor by which a transform lengthens a distance.
fn stretch(place: &WorldFromModel) -> f64 {
    let zero = place.transform_point(Vec3::ZERO);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| place.transform_point(axis) - zero);
    axes.iter().map(|axis| axis.length_squared()).sum::<f64>().sqrt()
}

/// The largest coordinate involved in placing a skinned mesh.
pub(super) fn coordinates(pose: &mut Pose, place: &WorldFromModel) -> f64 {
    let bounds = pose.broad_phase_bounds(&WorldFromModel::IDENTITY);
    let own = bounds.min.abs().max(bounds.max.abs()).max_element();
    f64::from(own) + place.transform_point(Vec3::ZERO).abs().max_element()
}
