//! Spheres, and their blend (Sect. 3.3).

use glam::{DMat3, DVec3};

use super::volume::Volume;
use crate::rivals::relative::{ROUNDINGS_F64, RoundedBody, abs, row_sum};

/// All points within `radius` of `centre`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sphere {
    centre: DVec3,
    radius: f64,
}

/// Compares spheres in world space, relative to A's origin.
#[derive(Clone, Debug)]
pub(super) struct SphereCulling {
    a: DMat3,
    b: DMat3,
    /// The largest factor by which each body stretches a radius.
    stretches: [f64; 2],
    offset: DVec3,
    slack: f64,
}

impl Volume for Sphere {
    type Culling = SphereCulling;

    const ZERO: Self = Self {
        centre: DVec3::ZERO,
        radius: 0.0,
    };

    /// The reference sphere of Eq. 8, around the middle of the points' box.
    fn around(points: &[DVec3]) -> Self {
        let least = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let most = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = 0.5 * (least + most);
        let radius = points.iter().map(|point| point.distance(centre)).fold(0.0, f64::max);
        Self { centre, radius }
    }

    /// A term of Eq. 7: `(c', r') = sum of w_i (c_i, r_i)`.
    ///
    /// Eq. 9 multiplies `|p - c| <= r` by `w >= 0`. For `w < 0`, which the paper does not have, it holds with `|w|`.
    #[inline]
    fn add(&mut self, weight: f64, other: &Self) {
        self.centre += weight * other.centre;
        self.radius += weight.abs() * other.radius;
    }

    /// Adds twice the error: the root of 3 for three coordinates, and room for the rounding of the radius.
    #[inline]
    fn widen(&mut self, error: f64) {
        self.radius += 2.0 * error;
    }

    #[inline]
    fn aabb(&self) -> [DVec3; 2] {
        [self.centre - self.radius, self.centre + self.radius]
    }

    fn culling(a: &RoundedBody, b: &RoundedBody) -> SphereCulling {
        SphereCulling {
            a: a.linear,
            b: b.linear,
            stretches: [a, b].map(|body| stretch(body.linear)),
            offset: b.translation - a.translation,
            // Covers the rounding of a centre as well: each centre is in the box around the root's sphere.
            slack: (a.error() + b.error()).length(),
        }
    }

    #[inline]
    fn overlap(culling: &SphereCulling, a: &Self, b: &Self) -> bool {
        let [stretch_a, stretch_b] = culling.stretches;
        let apart = culling.a * a.centre - (culling.b * b.centre + culling.offset);
        let reach = a.radius * stretch_a + b.radius * stretch_b + culling.slack;
        apart.length_squared() <= reach * reach
    }

    #[cfg(test)]
    fn contains(&self, point: DVec3) -> bool {
        point.distance(self.centre) <= self.radius
    }
}

/// At least the length of the longest image of a unit vector: `|M v|^2 = v . M^T M v`, and no eigenvalue of a symmetric
/// matrix exceeds its largest row sum. The factor covers the rounding here and that of the product with a radius.
fn stretch(linear: DMat3) -> f64 {
    (row_sum(abs(linear.transpose() * linear)) * (1.0 + ROUNDINGS_F64)).sqrt()
}
