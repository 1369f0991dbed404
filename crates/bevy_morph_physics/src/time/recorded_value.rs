//! The values that are recorded in every frame: weights, joints and transforms.

use bevy::math::{Affine3A, DVec3, Vec3};
use morph_collision::JointMatrices;

use crate::math::largest;

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
        let [a, b] = [self, other].map(Affine3A::to_cols_array);
        Self::from_cols_array(&std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share))
    }

    fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        std::iter::once(Vec3::from(self.translation).as_dvec3())
    }
}

/// Joints in the collider's space, and a point of the mesh, the middle of its bounds.
#[derive(Clone)]
pub struct JointSample {
    /// Shared by everything that remembers this moment.
    pub joints: JointMatrices,
    /// The middle of the mesh in its bind pose.
    pub middle: Vec3,
}

impl RecordedValue for JointSample {
    fn is_same(&self, other: &Self) -> bool {
        if self.joints == other.joints && self.middle == other.middle {
            return true;
        }
        let close = |a: &[f32; 12], b: &[f32; 12]| {
            let (a, b) = (&a[..9], &b[..9]);
            // Its scale may be that of another unit of length.
            let scale = largest(b.iter().map(|b| b.abs()));
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * scale)
        };
        // Removing the collider's isometry leaves rounding errors. Joints that move nearly always turn, which the first of them shows.
        let mut pairs = self.joints.iter().zip(other.joints.iter());
        if self.joints.len() != other.joints.len() || !pairs.all(|(a, b)| close(&a.to_cols_array(), &b.to_cols_array()))
        {
            return false;
        }
        let size = largest(other.points().map(|p| p.abs().max_element()));
        self.points()
            .zip(other.points())
            .all(|(a, b)| a.distance(b) <= 1e-6 * size)
    }

    fn interpolated(&self, other: &Self, share: f32) -> Self {
        let pairs = self.joints.iter().zip(other.joints.iter());
        let between = JointMatrices::from_matrices(pairs.map(|(a, b)| a.interpolated(&b, share)));
        Self {
            // Between numbers in range, all are.
            joints: between.unwrap_or_else(|_| self.joints.clone()),
            middle: self.middle,
        }
    }

    fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        let middle = |joint: Affine3A| joint.transform_point3(self.middle).as_dvec3();
        self.joints.iter().map(middle)
    }
}
