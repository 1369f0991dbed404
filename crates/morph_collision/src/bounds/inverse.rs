use glam::{DMat3, DVec3};

use super::rounding::U64;

/// The inverse of a linear map, with what is known of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inverse {
    pub(super) linear: DMat3,
    /// The largest row sum of the identity minus the product with what it inverts, from above.
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

    /// `None` where it is not safe.
    pub(super) fn new(linear: DMat3) -> Option<Self> {
        let inverse = inverse(linear)?;
        // inverse * linear = I - R gives |linear^-1 - inverse| <= |R| / (1 - |R|) |inverse|, with R's own rounding in it.
        let residual = abs(DMat3::IDENTITY - inverse * linear);
        let residual = norm(residual) + 8.0 * U64 * norm(abs(inverse) * abs(linear));
        (residual.is_finite() && residual <= 1.0 / 16.0).then(|| Self {
            linear: inverse,
            residual,
            largest: column_maxima(abs(inverse)),
        })
    }
}

/// The inverse with the matrix scaled to around 1 first, so that tiny and huge bodies invert as well as any other.
fn inverse(linear: DMat3) -> Option<DMat3> {
    let largest = column_maxima(abs(linear)).max_element();
    if largest == 0.0 {
        return None;
    }
    let scaled = linear * (1.0 / largest);
    if scaled.determinant().abs() < 1e-60 {
        return None;
    }
    let inverse = scaled.inverse() * (1.0 / largest);
    inverse.is_finite().then_some(inverse)
}

/// Entry by entry.
pub(super) fn abs(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// The largest row sum of a matrix without negative entries.
fn norm(m: DMat3) -> f64 {
    (m * DVec3::ONE).max_element()
}

fn column_maxima(m: DMat3) -> DVec3 {
    DVec3::new(m.x_axis.max_element(), m.y_axis.max_element(), m.z_axis.max_element())
}
