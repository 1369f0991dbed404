//! Predicts where a mesh will be at the end of a step, as Avian moves it.

use avian3d::prelude::{AngularVelocity, ComputedCenterOfMass, LinearVelocity, Position, RigidBody, Rotation};
use bevy::math::Affine3A;
use bevy::prelude::*;
use morph_collision::{InputError, JointMatrices, WorldFromModel};
use parry3d::math::Pose as Place;

use crate::physics::ahead::{Ahead, is_rigid, rigid_place};
use crate::physics::inside::is_mirrored;
use crate::physics::placed::joints_in;

/// The motion of the body on which a mesh is.
pub(super) struct Motion<'a> {
    pub(super) kind: RigidBody,
    /// A sleeping body stays, whatever its velocity.
    pub(super) asleep: bool,
    pub(super) position: &'a Position,
    pub(super) rotation: &'a Rotation,
    pub(super) linear: &'a LinearVelocity,
    pub(super) angular: &'a AngularVelocity,
    pub(super) center_of_mass: &'a ComputedCenterOfMass,
}

impl Motion<'_> {
    fn place(&self) -> Place {
        Place::from_parts(self.position.0, self.rotation.0)
    }

    /// Where the body will be in `dt` seconds if nothing pushes it.
    fn next(&self, dt: f32) -> Place {
        let rotation = (Quat::from_scaled_axis(self.angular.0 * dt) * self.rotation.0).normalize();
        let center = self.position.0 + self.rotation.0 * self.center_of_mass.0 + self.linear.0 * dt;
        Place::from_parts(center - rotation * self.center_of_mass.0, rotation)
    }
}

/// The joints of a skinned mesh.
pub(super) enum Joints<'a> {
    InWorld(&'a [Affine3A]),
    /// In the collider's space.
    InCollider(&'a [Affine3A]),
}

/// `own` is the collider's place, as Avian has it, if any; `body` is its body and its place in it. `joints` are those of a
/// skinned mesh as drawn, if they are known.
pub(super) fn ahead(
    entity: &GlobalTransform,
    own: Option<Place>,
    body: Option<(Motion, Place)>,
    (is_skinned, joints): (bool, Option<Joints>),
    dt: f32,
) -> Result<Ahead, InputError> {
    let affine_of = |place: &Place| Affine3A::from_rotation_translation(place.rotation, place.translation);
    // Avian's collider has a position and a rotation. What remains is scale and shear, which does not apply to joints.
    let place = body.as_ref().map(|(body, in_body)| body.place() * *in_body).or(own);
    let place = place.filter(is_rigid).unwrap_or_else(|| rigid_place(entity));
    let rigid = affine_of(&place);
    let affine = if is_skinned { rigid } else { entity.affine() };
    let collider_from_model = if is_skinned {
        Affine3A::IDENTITY
    } else {
        rigid.inverse() * affine
    };
    let mirrored = match &joints {
        Some(Joints::InWorld(joints) | Joints::InCollider(joints)) => is_mirrored(joints.iter()),
        None => is_mirrored([&collider_from_model].into_iter()),
    };
    let joints = joints.map(|joints| match joints {
        Joints::InWorld(joints) => JointMatrices::new(&joints_in(&place, joints)),
        Joints::InCollider(joints) => JointMatrices::new(joints),
    });
    let joints = joints.transpose()?;
    let world_from_model = match body {
        // Exactly the entity's transform, because that is where it is drawn.
        None => affine,
        // Avian moves it, and nothing else needs the value.
        Some((body, _)) if body.kind == RigidBody::Dynamic => Affine3A::IDENTITY,
        Some((body, in_body)) => {
            let next = match body.kind {
                RigidBody::Kinematic if !body.asleep => body.next(dt),
                _ => body.place(),
            };
            affine_of(&(next * in_body)) * collider_from_model
        }
    };
    Ok(Ahead {
        world_from_model: WorldFromModel::new(world_from_model)?,
        collider_from_model: WorldFromModel::new(collider_from_model)?,
        joints,
        mirrored,
        carried: false,
    })
}
