//! The placement of a body in the world.

use glam::{Affine3A, DMat3, DVec3, Vec3};

use super::inverse::Inverse;
use super::rounding::U64;
use crate::input_error::{InputError, check_vector};

/// A body's transform: a checked affine map from its model space to world space.
///
/// Every finite affine map is allowed, including non-uniform scale, shear, mirroring, and scale 0 along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldFromModel {
    linear: DMat3,
    translation: DVec3,
    /// Computed once, because every pair of bodies needs it; `None` if [`Inverse::new`] returns `None`.
    inverse: Option<Inverse>,
    scale: f64,
    /// Whether it turns outward windings inward.
    mirrors: bool,
}

impl Default for WorldFromModel {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl WorldFromModel {
    /// The identity: model space is world space.
    pub const IDENTITY: Self = Self {
        linear: DMat3::IDENTITY,
        translation: DVec3::ZERO,
        inverse: Some(Inverse::IDENTITY),
        scale: 1.0,
        mirrors: false,
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
        Ok(Self::from_columns([x, y, z, translation]))
    }

    /// The map with these columns, which must be finite.
    pub(crate) fn from_columns([x, y, z, translation]: [DVec3; 4]) -> Self {
        let linear = DMat3::from_cols(x, y, z);
        Self {
            linear,
            translation,
            inverse: Inverse::new(linear),
            scale: x.length().max(y.length()).max(z.length()),
            mirrors: linear.determinant() < 0.0,
        }
    }

    /// Whether the inverse magnifies rounding errors so little that boxes can be stored in this model space.
    pub(crate) fn is_well_conditioned(&self) -> bool {
        /// Not measured. Joints of characters are far below it; boxes above it are just as good in another space.
        const MAX_CONDITION: f64 = 1e3;
        let norm = (self.linear.abs() * DVec3::ONE).max_element();
        self.inverse.is_some() && self.inverse_norm() * norm <= MAX_CONDITION
    }

    /// The linear part of the inverse; the identity if there is no inverse.
    pub(super) fn inverse_linear(&self) -> DMat3 {
        self.inverse.map_or(DMat3::IDENTITY, |inverse| inverse.linear)
    }

    /// The largest sum of absolute values in a row of the inverse's linear part.
    pub(super) fn inverse_norm(&self) -> f64 {
        self.inverse.map_or(1.0, |inverse| inverse.rows.max_element())
    }

    /// The world's origin in model space, up to a few roundings.
    pub(crate) fn model_origin(&self) -> DVec3 {
        self.inverse_linear() * -self.translation
    }

    /// Takes a model-space point to world space: per coordinate `((m_x p_x + m_y p_y) + m_z p_z) + t` in `f64`.
    ///
    /// The products are exact, and the three sums are rounded in this order. All answers about meshes without joints are about
    /// these points.
    #[must_use]
    #[inline]
    pub fn transform_point(&self, point: Vec3) -> DVec3 {
        let p = point.as_dvec3();
        ((self.linear.x_axis * p.x + self.linear.y_axis * p.y) + self.linear.z_axis * p.z) + self.translation
    }

    /// A bound, along each axis, on the error of an exact world point in model space: its own error in the world is at most `world_error`,
    /// and its image is computed from numbers up to `reach` with at most 24 roundings. `None` if there is no inverse.
    pub(crate) fn model_error(&self, reach: f64, world_error: f64) -> Option<DVec3> {
        let inverse = self.inverse.as_ref()?;
        let all = 2.0 * (world_error + 16.0 * U64 * reach);
        Some(inverse.rows * all + DVec3::splat(inverse.error * (reach + world_error)))
    }

    /// Takes a model-space normal to world space. Its length is scaled like the area of its surface, so an area-weighted normal
    /// stays area-weighted.
    ///
    /// The normal is multiplied by the cofactor matrix, which needs no inverse and follows the winding if the map mirrors. The
    /// result is zero if the map flattens the surface to a line. Error: a few `f64` roundings.
    #[must_use]
    pub fn transform_normal(&self, normal: DVec3) -> DVec3 {
        let [x, y, z] = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        y.cross(z) * normal.x + z.cross(x) * normal.y + x.cross(y) * normal.z
    }

    /// Whether the map mirrors: it turns outward windings inward.
    pub(crate) fn mirrors(&self) -> bool {
        self.mirrors
    }

    /// The same map for a body whose vertices were mirrored before, or not.
    pub(crate) fn of_mirrored(self, mirrors: bool) -> Self {
        Self { mirrors, ..self }
    }

    /// Whether two maps have the same linear part and translation. Cheaper than `==`, which also compares derived values.
    #[inline]
    pub(crate) fn is_same_map(&self, other: &Self) -> bool {
        self.linear == other.linear && self.translation == other.translation
    }

    /// The same map with another translation.
    pub(crate) fn at(&self, translation: DVec3) -> Self {
        Self { translation, ..*self }
    }

    /// The length of the longest mapped unit axis.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// A bound on the absolute world coordinates of points within a magnitude.
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

    /// Its linear part.
    #[must_use]
    pub fn linear(&self) -> DMat3 {
        self.linear
    }

    /// Where it takes the origin.
    #[must_use]
    pub fn translation(&self) -> DVec3 {
        self.translation
    }
}
