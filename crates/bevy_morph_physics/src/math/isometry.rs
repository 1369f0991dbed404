//! Rotations with translations.

use bevy::math::Affine3A;
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

/// A rotation with a translation as an affine map.
pub fn affine_of(isometry: &Isometry) -> Affine3A {
    Affine3A::from_rotation_translation(isometry.rotation, isometry.translation)
}

/// Each entry of an affine map, interpolated linearly to that of another.
pub fn affine_between(from: &Affine3A, to: &Affine3A, share: f32) -> Affine3A {
    let [a, b] = [from, to].map(Affine3A::to_cols_array);
    Affine3A::from_cols_array(&std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share))
}

/// Whether an isometry is finite and rotates without scaling.
pub fn is_rigid(isometry: &Isometry) -> bool {
    // Also false for a rotation that is not finite.
    isometry.translation.is_finite() && (isometry.rotation.length_squared() - 1.0).abs() < 1e-3
}
