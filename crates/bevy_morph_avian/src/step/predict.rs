//! Predicts where a mesh will be at the end of a step, as Avian moves it.

use avian3d::prelude::RigidBody;
use bevy::math::Affine3A;
use bevy::prelude::*;
use bevy_morph_physics::math::{affine_of, is_rigid, rigid_part};
use bevy_morph_physics::moving::Prediction;
use bevy_morph_physics::posing::SurfaceJoints;
use morph_collision::{InputError, JointMatrices, WorldFromModel};
use parry3d::math::Pose as Isometry;

use super::query::BodyItem;
use crate::isometry::isometry;

/// The joints of a skinned mesh.
pub(super) enum Joints<'a> {
    /// As drawn, in world space, and the middle of the mesh in its bind pose.
    Drawn(&'a JointMatrices, Vec3),
    Between(SurfaceJoints),
}

/// What is known of a mesh before a step.
pub(super) struct Start<'a, 'w, 's> {
    pub(super) entity: &'a GlobalTransform,
    /// Where Avian has its collider, if it has one.
    pub(super) collider: Option<Isometry>,
    /// Its body.
    pub(super) body: Option<&'a BodyItem<'w, 's>>,
    /// Where its collider is in the body.
    pub(super) in_body: Isometry,
    pub(super) is_skinned: bool,
    /// The joints with which it is drawn, if they are known.
    pub(super) joints: Option<Joints<'a>>,
}

/// Where a mesh will be in `dt` seconds.
pub(super) fn predict(start: Start, dt: f32) -> Result<Prediction, InputError> {
    let Start {
        entity,
        collider,
        body,
        in_body,
        is_skinned,
        joints,
    } = start;
    // Avian's collider has a position and a rotation. What remains is scale and shear, which does not apply to joints.
    let now = body.map(|body| isometry(body.position, body.rotation) * in_body);
    let now = now.or(collider).filter(is_rigid).unwrap_or_else(|| rigid_part(entity));
    let rigid = affine_of(&now);
    let affine = if is_skinned { rigid } else { entity.affine() };
    let collider_from_model = if is_skinned {
        Affine3A::IDENTITY
    } else {
        rigid.inverse() * affine
    };
    let joints = joints.map(|joints| match joints {
        Joints::Drawn(joints, middle) => SurfaceJoints::drawn(joints.clone(), now, middle),
        Joints::Between(joints) => Ok(joints),
    });
    let world_from_model = match body {
        // Exactly the entity's transform, because that is where it is drawn.
        None => affine,
        // Avian moves it, and nothing else needs the value.
        Some(body) if *body.kind == RigidBody::Dynamic => Affine3A::IDENTITY,
        Some(body) => affine_of(&(next(body, dt) * in_body)) * collider_from_model,
    };
    Ok(Prediction {
        world_from_model: WorldFromModel::new(world_from_model)?,
        collider_from_model: WorldFromModel::new(collider_from_model)?,
        joints: joints.transpose()?,
        carried: false,
    })
}

/// Where a static or kinematic body will be in `dt` seconds.
fn next(body: &BodyItem, dt: f32) -> Isometry {
    // A sleeping body stays, whatever its velocity.
    if *body.kind != RigidBody::Kinematic || body.is_asleep {
        return isometry(body.position, body.rotation);
    }
    let rotation = (Quat::from_scaled_axis(body.angular.0 * dt) * body.rotation.0).normalize();
    let center = body.position.0 + body.rotation.0 * body.center_of_mass.0 + body.linear.0 * dt;
    Isometry::from_parts(center - rotation * body.center_of_mass.0, rotation)
}
