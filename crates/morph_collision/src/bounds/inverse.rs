//! The inverse of a map to the world, with bounds on its error.

use glam::{DMat3, DVec3};

use super::rounding::U64;

/// The inverse of a linear map, with a bound on its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inverse {
    pub(super) linear: DMat3,
    /// The row sums of the absolute values of `linear`.
    pub(super) rows: DVec3,
    /// The largest error of the image of a vector with coordinates within 1.
    pub(super) error: f64,
}

impl Inverse {
    pub(super) const IDENTITY: Self = Self {
        linear: DMat3::IDENTITY,
        rows: DVec3::ONE,
        error: 1.1 * 8.0 * U64 * 3.0,
    };

    /// `None` if the map is singular, or so close to singular that the error bound of the inverse is useless.
    pub(super) fn new(linear: DMat3) -> Option<Self> {
        // Scaled to entries around 1, so that tiny and huge bodies are inverted as accurately as others.
        let size = column_maxima(linear.abs()).max_element();
        let scaled = linear * (1.0 / size);
        if size == 0.0 || scaled.determinant().abs() < 1e-60 {
            return None;
        }
        let inverse = scaled.inverse() * (1.0 / size);
        // With inverse * linear = I - R, |linear^-1 - inverse| <= |R| / (1 - |R|) |inverse|. The second term covers the rounding
        // of R.
        let norm = |m: DMat3| (m * DVec3::ONE).max_element();
        let residual =
            norm((DMat3::IDENTITY - inverse * linear).abs()) + 8.0 * U64 * norm(inverse.abs() * linear.abs());
        (inverse.is_finite() && residual <= 1.0 / 16.0).then(|| Self {
            linear: inverse,
            rows: inverse.abs() * DVec3::ONE,
            // 1.1 is more than `1 / (1 - residual)`.
            error: 1.1 * residual * column_maxima(inverse.abs()).element_sum(),
        })
    }
}

fn column_maxima(m: DMat3) -> DVec3 {
    DVec3::new(m.x_axis.max_element(), m.y_axis.max_element(), m.z_axis.max_element())
}
