//! The values that are recorded in every frame: weights, joints and transforms.

use bevy::math::{Affine3A, DVec3, Vec3};

use crate::math::affine_between;
use crate::posing::SurfaceJoints;

/// A value that determines a surface: weights, joints or transform.
pub trait RecordedValue: Clone {
    /// Whether two values are the same up to rounding.
    fn is_same(&self, other: &Self) -> bool;

    /// Interpolates linearly to another value.
    fn interpolated(&self, other: &Self, share: f32) -> Self;

    /// Points that move far if the surface teleports. None if the value cannot teleport.
    fn points(&self) -> impl Iterator<Item = DVec3> + Clone;
}

impl RecordedValue for Vec<f32> {
    fn is_same(&self, other: &Self) -> bool {
        self == other
    }

    fn interpolated(&self, other: &Self, share: f32) -> Self {
        let between = |(a, b): (&f32, &f32)| a + (b - a) * share;
        self.iter().zip(other).map(between).collect()
    }

    fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        std::iter::empty()
    }
}

impl RecordedValue for Affine3A {
    fn is_same(&self, other: &Self) -> bool {
        self == other
    }

    fn interpolated(&self, other: &Self, share: f32) -> Self {
        affine_between(self, other, share)
    }

    fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        std::iter::once(Vec3::from(self.translation).as_dvec3())
    }
}

impl RecordedValue for SurfaceJoints {
    fn is_same(&self, other: &Self) -> bool {
        self.is_same(other)
    }

    fn interpolated(&self, other: &Self, share: f32) -> Self {
        self.between(other, share)
    }

    fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        self.middles().iter().map(|middle| middle.as_dvec3())
    }
}
