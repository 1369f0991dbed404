use glam::{Affine3A, DMat3, DVec3, Vec3};

use super::inverse::Inverse;
use super::rounding::U64;
use crate::input_error::{InputError, check_vector};

/// Where a body stands: a checked affine map from its model space to world space.
///
/// Every finite affine map is allowed: non-uniform scale, shear, mirroring, and scale 0 along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldFromModel {
    linear: DMat3,
    translation: DVec3,
    /// Computed once, because every pair of bodies needs it; `None` where [`Inverse::new`] refuses.
    inverse: Option<Inverse>,
    scale: f64,
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

    /// Checks an affine map.
    ///
    /// # Errors
    /// [`InputError`] names the first entry that is NaN or infinite.
    pub fn new(world_from_model: Affine3A) -> Result<Self, InputError> {
        let [x, y, z, translation] = world_from_model
            .to_cols_array_2d()
            .map(|column| Vec3::from_array(column).as_dvec3());
        for (what, column) in [
            ("x axis of world_from_model", x),
            ("y axis of world_from_model", y),
            ("z axis of world_from_model", z),
            ("translation of world_from_model", translation),
        ] {
            check_vector(what, column, f64::from(f32::MAX))?;
        }
        let linear = DMat3::from_cols(x, y, z);
        Ok(Self {
            linear,
            translation,
            inverse: Inverse::new(linear),
            scale: x.length().max(y.length()).max(z.length()),
        })
    }

    /// A model-space point in world space: per coordinate `((m_x p_x + m_y p_y) + m_z p_z) + t` in `f64`.
    ///
    /// The products are exact; the three sums are rounded in this order. Every answer of this crate is about these points.
    #[must_use]
    #[inline]
    pub fn transform_point(&self, point: Vec3) -> DVec3 {
        let p = point.as_dvec3();
        ((self.linear.x_axis * p.x + self.linear.y_axis * p.y) + self.linear.z_axis * p.z) + self.translation
    }

    /// A model-space normal in world space, scaled as the area of its surface is scaled: an area-weighted normal stays one.
    ///
    /// It is multiplied by the cofactor matrix, which needs no inverse and follows the winding through a mirroring. The
    /// result is zero where the map flattens the surface to a line. Error: a few `f64` roundings.
    #[must_use]
    pub fn transform_normal(&self, normal: DVec3) -> DVec3 {
        let [x, y, z] = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        y.cross(z) * normal.x + z.cross(x) * normal.y + x.cross(y) * normal.z
    }

    /// Whether the map turns outward windings inward.
    pub(crate) fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }

    /// Whether two maps are the same, whatever was computed from them.
    #[inline]
    pub(crate) fn is_same_map(&self, other: &Self) -> bool {
        self.linear == other.linear && self.translation == other.translation
    }

    /// The same map followed by a translation in world space.
    #[cfg(test)]
    pub(crate) fn translated(&self, by: DVec3) -> Self {
        Self {
            translation: self.translation + by,
            ..*self
        }
    }

    /// The length of the longest image of a unit axis.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// The largest absolute world coordinates of points within a magnitude.
    pub(crate) fn reach(&self, magnitude: DVec3) -> DVec3 {
        self.linear.abs() * magnitude + self.translation.abs()
    }

    /// A bound on the error of [`WorldFromModel::transform_point`] for points within a magnitude, per world axis.
    pub(crate) fn placement_error(&self, magnitude: DVec3) -> DVec3 {
        4.0 * U64 * self.reach(magnitude)
    }

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
