//! Where a mesh will be at the end of a step.

use bevy::prelude::*;
use morph_collision::{JointMatrices, WorldFromModel};
use parry3d::math::Pose as Place;

/// Where a mesh will be at the end of a step.
pub(crate) struct Ahead {
    /// From the space of its pose, which is the collider's space for a skinned mesh.
    pub(crate) world_from_model: WorldFromModel,
    pub(crate) collider_from_model: WorldFromModel,
    /// In the collider's space.
    pub(crate) joints: Option<JointMatrices>,
    /// Whether its transform or its joints mirror it.
    pub(crate) mirrored: bool,
    /// Whether a dynamic body carries it. `world_from_model` is then its place at the start of the step.
    pub(crate) carried: bool,
}

/// The place of an entity without its scale and shear. The rotation of an entity scaled to zero is the identity.
pub(crate) fn rigid_place(entity: &GlobalTransform) -> Place {
    let (_, rotation, translation) = entity.to_scale_rotation_translation();
    let place = Place::from_parts(translation, rotation);
    if is_rigid(&place) {
        place
    } else {
        Place::from_parts(translation, Quat::IDENTITY)
    }
}

/// Whether a place is finite and rotates without scaling.
pub(crate) fn is_rigid(place: &Place) -> bool {
    // Also false for a rotation that is not finite.
    place.translation.is_finite() && (place.rotation.length_squared() - 1.0).abs() < 1e-3
}
