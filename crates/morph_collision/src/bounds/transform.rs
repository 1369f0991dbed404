use glam::{Affine3A, DMat3, DVec3, Vec3};
use thiserror::Error;

use super::inverse::Inverse;

/// Where a body stands: a validated affine map from its model space to world space.
///
/// Any finite affine will do: non-uniform scale, shear, mirroring, even scale 0 along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldFromModel {
    linear: DMat3,
    translation: DVec3,
    /// Found once, since every pair of bodies needs it.
    inverse: Option<Inverse>,
    scale: f64,
}

/// Why an affine map cannot place a body.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TransformError {
    /// An entry is NaN or infinite.
    #[error("world_from_model: column {column}, row {row} is {value}, not a finite number")]
    NotFinite {
        /// 0 to 2 for the axes, 3 for the translation.
        column: usize,
        /// 0 to 2.
        row: usize,
        /// The offending entry.
        value: f32,
    },
}

impl Default for WorldFromModel {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl WorldFromModel {
    /// Model space is world space.
    pub const IDENTITY: Self = Self {
        linear: DMat3::IDENTITY,
        translation: DVec3::ZERO,
        inverse: Some(Inverse::IDENTITY),
        scale: 1.0,
    };

    /// Validates an affine map.
    ///
    /// # Errors
    /// [`TransformError::NotFinite`] names the first entry that is NaN or infinite.
    pub fn new(world_from_model: Affine3A) -> Result<Self, TransformError> {
        let columns = world_from_model.to_cols_array_2d();
        for (column, entries) in columns.iter().enumerate() {
            for (row, &value) in entries.iter().enumerate() {
                if !value.is_finite() {
                    return Err(TransformError::NotFinite { column, row, value });
                }
            }
        }
        let [x, y, z, t] = columns.map(|c| Vec3::from_array(c).as_dvec3());
        let linear = DMat3::from_cols(x, y, z);
        Ok(Self {
            linear,
            translation: t,
            inverse: Inverse::of(linear),
            scale: x.length().max(y.length()).max(z.length()),
        })
    }

    /// A model-space point in world space: per coordinate `((m_x p_x + m_y p_y) + m_z p_z) + t` in `f64`.
    ///
    /// The products are exact, the three sums are rounded in this order. This is part of the contract of every answer.
    #[must_use]
    #[inline]
    pub fn transform_point(&self, point: Vec3) -> DVec3 {
        let p = point.as_dvec3();
        ((self.linear.x_axis * p.x + self.linear.y_axis * p.y) + self.linear.z_axis * p.z) + self.translation
    }

    /// The world-space direction normal to what a model-space normal is normal to, with the length that an area-weighted
    /// normal gets: by the matrix of cofactors, which needs no inverse and follows the winding through a mirroring.
    ///
    /// Zero for a surface that the map flattens to a line. Not exact: a few roundings of `f64`.
    #[must_use]
    pub fn transform_normal(&self, normal: DVec3) -> DVec3 {
        let [x, y, z] = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        y.cross(z) * normal.x + z.cross(x) * normal.y + x.cross(y) * normal.z
    }

    /// Whether it turns outward windings inward.
    pub(crate) fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }

    /// The same placement, moved.
    #[cfg(test)]
    pub(crate) fn translated(&self, by: DVec3) -> Self {
        Self {
            translation: self.translation + by,
            ..*self
        }
    }

    /// A typical stretch: the longest image of a unit axis.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// `None` for a map that cannot be inverted safely.
    pub(super) fn inverse(&self) -> Option<&Inverse> {
        self.inverse.as_ref()
    }

    pub(crate) fn linear(&self) -> DMat3 {
        self.linear
    }

    pub(crate) fn translation(&self) -> DVec3 {
        self.translation
    }
}
