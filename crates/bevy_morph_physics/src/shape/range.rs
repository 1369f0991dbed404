//! The sizes and positions with which Parry can compute.

use parry3d::bounding_volume::Aabb;
use parry3d::math::{Real, Vector};

/// The largest coordinate that is passed to Parry, in world units; for velocities, in units per second.
///
/// Parry multiplies up to four lengths. In `f32` that overflows at lengths of 4.3e9. In measurements, answers are right up to
/// 2^30 = 1.1e9, and wrong, infinite or NaN from 2^32 on. From 6e18 on, squares overflow and EPA panics (`docs/rapier.md`).
/// Differences between corners of two shapes are up to 4 sqrt(3) = 7 times as large as a coordinate, so with 1e8 they stay below
/// 1.1e9.
pub const MAX_COORDINATE: Real = 1e8;

/// Whether every component is within [`MAX_COORDINATE`]; NaN is not.
pub fn in_range(vector: Vector) -> bool {
    vector.abs().cmple(Vector::splat(MAX_COORDINATE)).all()
}

/// The same for both corners of a box.
pub fn box_in_range(bounds: &Aabb) -> bool {
    in_range(bounds.mins) && in_range(bounds.maxs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_out_of_range() {
        for bad in [Real::NAN, Real::INFINITY, -Real::INFINITY, 1e30, -1.1e8] {
            assert!(!in_range(Vector::new(0.0, bad, 0.0)), "{bad}");
        }
        assert!(in_range(Vector::splat(1e8)) && in_range(Vector::splat(-1e-30)));
    }
}
