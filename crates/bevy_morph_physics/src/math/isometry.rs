//! Rotations with translations.

use bevy::prelude::*;
use parry3d::math::Pose as Isometry;

/// The transform of an entity without its scale and shear. The rotation of an entity scaled to zero is the identity.
pub fn rigid_part(entity: &GlobalTransform) -> Isometry {
    let (_, rotation, translation) = entity.to_scale_rotation_translation();
    let isometry = Isometry::from_parts(translation, rotation);
    if is_rigid(&isometry) {
        isometry
    } else {
        Isometry::from_parts(translation, Quat::IDENTITY)
    }
}

/// Whether an isometry is finite and rotates without scaling.
pub fn is_rigid(isometry: &Isometry) -> bool {
    // Also false for a rotation that is not finite.
    isometry.translation.is_finite() && (isometry.rotation.length_squared() - 1.0).abs() < 1e-3
}
