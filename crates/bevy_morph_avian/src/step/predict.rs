//! Predicts where a mesh will be at the end of a step, as Avian moves it.

use avian3d::prelude::RigidBody;
use bevy::math::Affine3A;
use bevy::prelude::*;
use bevy_morph_physics::math::{is_rigid, joints_in, rigid_part};
use bevy_morph_physics::moving::Prediction;
use bevy_morph_physics::shape::is_mirrored;
use morph_collision::{InputError, JointMatrices, WorldFromModel};
use parry3d::math::Pose as Isometry;

use super::query::BodyItem;
use crate::isometry::isometry;

/// The joints of a skinned mesh.
pub(super) enum Joints<'a> {
    InWorld(&'a [Affine3A]),
    /// In the collider's space.
    InCollider(JointMatrices),
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
    let affine_of = |isometry: &Isometry| Affine3A::from_rotation_translation(isometry.rotation, isometry.translation);
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
        Joints::InWorld(joints) => JointMatrices::from_matrices(joints_in(&now, joints)),
        Joints::InCollider(joints) => Ok(joints),
    });
    let joints = joints.transpose()?;
    let mirrored = match &joints {
        Some(joints) => is_mirrored(joints.iter()),
        None => is_mirrored([collider_from_model].into_iter()),
    };
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
        joints,
        mirrored,
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
