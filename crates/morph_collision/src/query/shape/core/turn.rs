//! Rotations by angles. The sine and the arctangent of the standard library differ between machines, those of `libm` do not.

use std::f64::consts::PI;

use glam::{DMat3, DQuat, DVec3};

/// The rotation around an axis by the axis's length in radians.
pub(in super::super) fn turn(scaled_axis: DVec3) -> DMat3 {
    let angle = scaled_axis.length();
    if angle == 0.0 {
        return DMat3::IDENTITY;
    }
    let (sine, cosine) = libm::sincos(0.5 * angle);
    let axis = scaled_axis * (sine / angle);
    DMat3::from_quat(DQuat::from_xyzw(axis.x, axis.y, axis.z, cosine))
}

/// The axis of the shortest way to a rotation, times its angle in radians.
pub(super) fn scaled_axis(rotation: DQuat) -> DVec3 {
    let DQuat { x, y, z, w } = if rotation.w < 0.0 { -rotation } else { rotation };
    along(DVec3::new(x, y, z), |sine| 2.0 * libm::atan2(sine, w))
}

/// The same for the shortest rotation from one unit vector to another.
pub(super) fn arc(from: DVec3, to: DVec3) -> DVec3 {
    const OPPOSITE: f64 = 2.0 * f64::EPSILON - 1.0;
    let cosine = from.dot(to);
    if cosine < OPPOSITE {
        return from.any_orthonormal_vector() * PI;
    }
    along(from.cross(to), |sine| libm::atan2(sine, cosine))
}

/// An axis times the angle whose sine is its length. Zero if it is too short to have a direction.
fn along(axis: DVec3, angle: impl Fn(f64) -> f64) -> DVec3 {
    let sine = axis.length();
    if sine > 0.0 {
        axis * (angle(sine) / sine)
    } else {
        DVec3::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_those_of_glam() {
        for i in 0..200 {
            let i = f64::from(i);
            let axis = DVec3::new((1.3 * i) % 2.0 - 1.0, (0.7 * i) % 2.0 - 1.0, (0.3 * i) % 2.0 - 0.9).normalize();
            let angle = 0.017 * i;
            let expected = DMat3::from_axis_angle(axis, angle);
            assert!(turn(axis * angle).abs_diff_eq(expected, 1e-14));
            // Both go the short way.
            if angle < PI {
                let found = scaled_axis(DQuat::from_axis_angle(axis, angle));
                assert!(found.abs_diff_eq(axis * angle, 1e-14 * (1.0 + angle)), "{found}");
                let across = axis.any_orthonormal_vector();
                let found = arc(across, expected * across);
                assert!(found.abs_diff_eq(axis * angle, 1e-7), "{found} for {}", axis * angle);
            }
        }
        assert_eq!(arc(DVec3::X, DVec3::NEG_X).length(), PI);
        assert_eq!(arc(DVec3::X, DVec3::X), DVec3::ZERO);
    }
}
