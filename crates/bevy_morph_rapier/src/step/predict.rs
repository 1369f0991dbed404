//! Predicts where a mesh will be at the end of a step, as Rapier moves it.

use bevy::math::Affine3A;
use bevy::prelude::*;
use bevy_morph_physics::math::{affine_of, rigid_part};
use bevy_morph_physics::moving::Prediction;
use bevy_morph_physics::time::Live;
use bevy_rapier3d::parry::math::Pose as Isometry;
use bevy_rapier3d::rapier::dynamics::{RigidBodySet, RigidBodyType};
use bevy_rapier3d::rapier::geometry::Collider as RapierCollider;
use morph_collision::{InputError, WorldFromModel};

/// `live` is what the surface will be drawn with.
pub(crate) fn predict(
    collider: &RapierCollider,
    bodies: &RigidBodySet,
    live: &Live,
    is_skinned: bool,
    dt: f32,
) -> Result<Prediction, InputError> {
    let entity = &GlobalTransform::from(live.transform);
    // Rapier's collider has the entity's position and rotation. What remains is scale and shear, which does not apply to
    // joints.
    let isometry = rigid_part(entity);
    let rigid = affine_of(&isometry);
    let affine = if is_skinned { rigid } else { entity.affine() };
    let collider_from_model = if is_skinned {
        Affine3A::IDENTITY
    } else {
        rigid.inverse() * affine
    };
    let joints = live.joints.clone()?;
    let to = |world_from_model, carried| {
        Ok(Prediction {
            world_from_model,
            collider_from_model: WorldFromModel::new(collider_from_model)?,
            joints,
            carried,
        })
    };
    let in_body = collider.position_wrt_parent().copied();
    let body = collider.parent().and_then(|body| bodies.get(body)).zip(in_body);
    let Some((body, in_body)) = body else {
        // Exactly the entity's transform, because that is where it is drawn.
        return to(WorldFromModel::new(affine)?, false);
    };
    let isometry: Isometry = match body.body_type() {
        RigidBodyType::KinematicPositionBased => *body.next_position(),
        RigidBodyType::KinematicVelocityBased => body.predict_position_using_velocity(dt),
        // Where Rapier moves a dynamic body is not known yet.
        _ => *body.position(),
    } * in_body;
    to(
        WorldFromModel::new(affine_of(&isometry) * collider_from_model)?,
        body.is_dynamic(),
    )
}
