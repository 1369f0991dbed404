//! A pose whose space is mapped to the world.
//!
//! A skinned pose is in the space of its collider, because its joints are given in that space. Like any other pose, it is then
//! placed by an affine map. The core's queries do not use such a map for skinned poses, so this module does.

use bevy::math::{Affine3A, DAffine3, DMat3, DVec3};
use bevy::prelude::*;
use morph_collision::{Aabb, ConvexRegion, InputError, Pose, WorldFromModel};
use parry3d::bounding_volume::Aabb as ParryAabb;
use parry3d::math::Pose as Isometry;

use super::isometry::affine_of;

/// A world-space box around a box that an affine map takes to the world.
pub fn mapped(bounds: &Aabb, world_from_model: &WorldFromModel) -> Aabb {
    let corners = corners(bounds).map(|corner| world_from_model.transform_point(corner));
    let min = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let max = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    Aabb {
        min: min.as_vec3().map(f32::next_down),
        max: max.as_vec3().map(f32::next_up),
    }
}

/// The corners of a box.
pub fn corners(bounds: &Aabb) -> [Vec3; 8] {
    std::array::from_fn(|i| {
        let pick = |axis: usize| {
            if i >> axis & 1 == 0 {
                bounds.min[axis]
            } else {
                bounds.max[axis]
            }
        };
        Vec3::new(pick(0), pick(1), pick(2))
    })
}

/// Converts a world-space box to a region for queries about a pose.
pub fn region(bounds: &ParryAabb, pose: &Pose, world_from_model: &WorldFromModel) -> Result<ConvexRegion, InputError> {
    if pose.joints().is_none() {
        return ConvexRegion::from_aabb(&Aabb {
            min: bounds.mins,
            max: bounds.maxs,
        });
    }
    let origin = world_from_model.transform_point(Vec3::ZERO);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| world_from_model.transform_point(axis) - origin);
    let (min, max) = (bounds.mins.as_dvec3(), bounds.maxs.as_dvec3());
    let slab = |axis: usize| {
        let along = DVec3::from_array(axes.map(|column| column[axis]));
        [(along, origin[axis] - min[axis]), (-along, max[axis] - origin[axis])]
    };
    ConvexRegion::from_half_spaces([0, 1, 2].map(slab).as_flattened())
}

/// Converts a point from the space to which `world_from_model` maps, for queries about a pose.
pub fn into_query(point: DVec3, pose: &Pose, world_from_model: &WorldFromModel) -> DVec3 {
    if pose.joints().is_none() {
        return point;
    }
    let origin = world_from_model.transform_point(Vec3::ZERO);
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| world_from_model.transform_point(axis) - origin);
    // A collider's isometry rotates and translates, but does not scale.
    let away = point - origin;
    DVec3::new(x.dot(away), y.dot(away), z.dot(away))
}

/// Converts from world space to that of a collider.
pub fn collider_from_world(collider: &Isometry) -> DAffine3 {
    precise(&affine_of(collider)).inverse()
}

/// Converts a joint's matrix to the space of a collider.
pub fn joint_in(collider_from_world: &DAffine3, world_from_mesh: &Affine3A) -> Affine3A {
    let DAffine3 { matrix3, translation } = *collider_from_world * precise(world_from_mesh);
    let [x, y, z] = [matrix3.x_axis, matrix3.y_axis, matrix3.z_axis].map(DVec3::as_vec3);
    Affine3A::from_mat3_translation(Mat3::from_cols(x, y, z), translation.as_vec3())
}

/// An affine map in `f64`.
pub fn precise(affine: &Affine3A) -> DAffine3 {
    let [x, y, z] = [0, 1, 2].map(|axis| Vec3::from(affine.matrix3.col(axis)).as_dvec3());
    DAffine3 {
        matrix3: DMat3::from_cols(x, y, z),
        translation: Vec3::from(affine.translation).as_dvec3(),
    }
}
