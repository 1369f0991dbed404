//! A transform relative to a parent.

use glam::{Affine3A, Quat, Vec3};

/// A transform relative to a parent: scales first, then rotates, then translates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalTransform {
    /// The translation.
    pub translation: Vec3,
    /// The rotation, of length 1.
    pub rotation: Quat,
    /// The scale per axis.
    pub scale: Vec3,
}

impl Default for LocalTransform {
    fn default() -> Self {
        Self {
            translation: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            scale: Vec3::ONE,
        }
    }
}

impl LocalTransform {
    pub(super) fn affine(&self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}
