//! Coordinates on a binary grid.
//!
//! `sin` and `cos` differ in their last bits between platforms, but models have to be the same everywhere. Snapping
//! to multiples of 2^-18 removes the difference. It also gives coordinates below 2 only 19 significant bits, so that
//! sums, differences and the midpoints of five subdivisions are exact in `f32`.

use glam::{DVec3, Vec3};

/// Grid points per unit.
const PER_UNIT: f64 = (1 << 18) as f64;

/// The nearest grid point.
pub(super) fn snap(p: DVec3) -> Vec3 {
    ((p * PER_UNIT).round() / PER_UNIT).as_vec3()
}

/// A weight or an angle, rounded to 1e-6 for the same reason. The step is decimal because people read these numbers
/// in files.
pub(crate) fn round6(value: f64) -> f32 {
    // Adding zero turns -0 into 0.
    ((value * 1e6).round() / 1e6 + 0.0) as f32
}
