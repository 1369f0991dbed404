//! Signs of orientation determinants, exact for all finite points. Computed by the adaptive predicates of the `robust` crate
//! (Shewchuk 1997) if products stay in range, otherwise in exact arithmetic.

use std::cmp::Ordering;

use glam::{DVec2, DVec3, Vec3Swizzles};
use robust::{Coord, Coord3D};

use super::dyadic::Dyadic;
use super::number::{Number, Vector, cross, cross_coordinate, difference, dot, power_of_two};

/// The side of the plane through `a`, `b`, `c` on which `d` lies; `Equal` if `d` is in the plane or the three points span none.
#[inline]
pub(crate) fn plane_side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Ordering {
    if !in_range([a, b, c, d].iter().flat_map(DVec3::to_array)) {
        return plane_determinant(a, b, c, d).order();
    }
    sign(plane_height(a, b, c, d))
}

/// A number roughly proportional to the height of `d` over the plane. For points in range its sign is [`plane_side`].
#[inline]
pub(crate) fn plane_height(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let point = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    robust::orient3d(point(a), point(b), point(c), point(d))
}

/// Where the segment from `p` to `q` crosses the plane, as a fraction of its length. Accurate to a few roundings at any angle.
#[cold]
pub(crate) fn plane_crossing([a, b, c]: [DVec3; 3], [p, q]: [DVec3; 2]) -> f64 {
    fraction(plane_determinant(a, b, c, p), plane_determinant(a, b, c, q))
}

/// Where the segment from `p` to `q` crosses the line through `a` and `b`, as a fraction of its length. Accurate to a few roundings.
#[cold]
pub(crate) fn line_crossing([a, b]: [DVec2; 2], [p, q]: [DVec2; 2]) -> f64 {
    fraction(line_determinant(a, b, p), line_determinant(a, b, q))
}

fn fraction(first: Dyadic, second: Dyadic) -> f64 {
    first.over(&first.minus(&second))
}

/// The side of the line through `a`, `b` on which `c` lies; `Equal` if `c` is on the line or `a` equals `b`.
#[inline]
pub(crate) fn line_side(a: DVec2, b: DVec2, c: DVec2) -> Ordering {
    if !in_range([a, b, c].iter().flat_map(DVec2::to_array)) {
        return line_determinant(a, b, c).order();
    }
    sign(line_height(a, b, c))
}

/// A number roughly proportional to the distance of `c` from the line. For points in range its sign is [`line_side`].
#[inline]
pub(crate) fn line_height(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let point = |p: DVec2| Coord { x: p.x, y: p.y };
    robust::orient2d(point(a), point(b), point(c))
}

/// Whether no part of any product of three differences of these coordinates can overflow or underflow. Each coordinate must be 0,
/// or have an absolute value between `2^-277` and `2^300`. It is then an integer multiple of `2^-330`.
///
/// Corners of bodies in world space are always below `2^256`, and those of bodies without joints are integer multiples of `2^-298`.
/// So only tiny coordinates take the slow path needlessly.
#[inline]
fn in_range(mut coordinates: impl Iterator<Item = f64>) -> bool {
    const MIN: f64 = power_of_two(-277);
    const MAX: f64 = power_of_two(300);
    coordinates.all(|c| c == 0.0 || (MIN..=MAX).contains(&c.abs()))
}

#[cold]
fn plane_determinant(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Dyadic {
    let [a, b, c]: [Vector<Dyadic>; 3] = [a, b, c].map(|corner| difference(corner, d));
    dot(&a, &cross(&b, &c))
}

#[cold]
fn line_determinant(a: DVec2, b: DVec2, c: DVec2) -> Dyadic {
    let [a, b] = [a, b].map(|end| difference(end.extend(0.0), c.extend(0.0)));
    cross_coordinate(&a, &b, 2)
}

/// Determinants of finite points in range are not NaN.
fn sign(determinant: f64) -> Ordering {
    determinant.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// A projection along a coordinate axis. It drops that coordinate, so it is exact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    axis: usize,
}

impl Projection {
    /// A projection that is one-to-one on the plane through three points; `None` if the points are collinear.
    pub(crate) fn of_plane(points: [DVec3; 3]) -> Option<Self> {
        (0..3).map(|axis| Self { axis }).find(|projection| {
            let [a, b, c] = points.map(|p| projection.apply(p));
            line_side(a, b, c) != Ordering::Equal
        })
    }

    pub(crate) fn apply(self, p: DVec3) -> DVec2 {
        match self.axis {
            0 => p.yz(),
            1 => p.zx(),
            _ => p.xy(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_found_at_any_angle() {
        for slope in [1.0, power_of_two(-30), power_of_two(-600)] {
            let at = |x: f64| DVec3::new(1e9 * x, 7.0, slope * x);
            let plane = [DVec3::ZERO, DVec3::X, DVec3::Y];
            assert_eq!(plane_crossing(plane, [at(-3.0), at(5.0)]), 0.375);
            let [from, to] = [at(-3.0), at(5.0)].map(DVec3::xz);
            assert_eq!(line_crossing([DVec2::ZERO, DVec2::X], [from, to]), 0.375);
        }
    }
}
