use glam::{DMat3, DVec3};

use super::rounding::U64;

/// The inverse of a linear map, with a bound on its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inverse {
    pub(super) linear: DMat3,
    /// A bound on the largest row sum of `|I - linear m|`, where `m` is the map that was inverted.
    pub(super) residual: f64,
    /// The largest absolute entry of each column.
    pub(super) largest: DVec3,
}

impl Inverse {
    pub(super) const IDENTITY: Self = Self {
        linear: DMat3::IDENTITY,
        residual: 8.0 * U64,
        largest: DVec3::ONE,
    };

    /// `None` where the map is singular, or so nearly that the inverse's error bound is useless.
    pub(super) fn new(linear: DMat3) -> Option<Self> {
        // Scaled to entries around 1, so that tiny and huge bodies are inverted as well as any other.
        let size = column_maxima(abs(linear)).max_element();
        let scaled = linear * (1.0 / size);
        if size == 0.0 || scaled.determinant().abs() < 1e-60 {
            return None;
        }
        let inverse = scaled.inverse() * (1.0 / size);
        // With inverse * linear = I - R, |linear^-1 - inverse| <= |R| / (1 - |R|) |inverse|. R itself is rounded.
        let norm = |m: DMat3| (m * DVec3::ONE).max_element();
        let residual = norm(abs(DMat3::IDENTITY - inverse * linear)) + 8.0 * U64 * norm(abs(inverse) * abs(linear));
        (inverse.is_finite() && residual <= 1.0 / 16.0).then(|| Self {
            linear: inverse,
            residual,
            largest: column_maxima(abs(inverse)),
        })
    }
}

/// The absolute values of all entries.
pub(super) fn abs(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

fn column_maxima(m: DMat3) -> DVec3 {
    DVec3::new(m.x_axis.max_element(), m.y_axis.max_element(), m.z_axis.max_element())
}
