//! The first test of two triangles, in `f64` with an error bound. It decides most pairs.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use glam::DVec3;

use super::number::{UNIT_ROUNDOFF, power_of_two};
use super::triangle::{Triangle, strictly_one_side};

/// A triangle with the values that the filter computes once per triangle.
#[derive(Clone, Debug)]
pub(crate) struct Facet {
    pub(crate) corners: Triangle,
    normal: DVec3,
    /// The product of the largest coordinates of the two edges that span the normal.
    size: f64,
}

impl Facet {
    #[inline]
    pub(crate) fn new(corners: Triangle) -> Self {
        let [a, b, c] = corners;
        let (u, v) = (b - a, c - a);
        Self {
            corners,
            normal: u.cross(v),
            size: largest(u) * largest(v),
        }
    }

    /// The sides of the plane on which the corners of a triangle lie; `Equal` where that is not certain.
    #[inline]
    fn sides(&self, &[a, b, c]: &Triangle) -> [Ordering; 3] {
        [self.side(a), self.side(b), self.side(c)]
    }

    #[inline]
    fn side(&self, corner: DVec3) -> Ordering {
        let to = corner - self.corners[0];
        certain_sign(self.normal.dot(to), self.size * largest(to))
    }
}

/// Whether two closed triangles share a point; `None` if the sign of a needed determinant is not certain.
///
/// Triangles that touch, are coplanar or are degenerate are undecided unless a plane separates them with certainty. Cost: six
/// heights over planes, and two determinants if each triangle crosses the other's plane.
///
/// If each triangle crosses the other's plane and no corner is in it, each triangle has a lone corner, with the other two on the
/// opposite side. The two edges from that corner bound the triangle's interval on the common line of the planes, and two
/// determinants tell whether the two intervals overlap (Guigue and Devillers 2003).
#[inline]
pub(super) fn facets_intersect(facet_a: &Facet, facet_b: &Facet) -> Option<bool> {
    let (a, b) = (&facet_a.corners, &facet_b.corners);
    let b_sides = facet_a.sides(b);
    if strictly_one_side(b_sides) {
        return Some(false);
    }
    let a_sides = facet_b.sides(a);
    if strictly_one_side(a_sides) {
        return Some(false);
    }
    if a_sides.contains(&Equal) || b_sides.contains(&Equal) {
        return None;
    }
    let ([p, mut q, mut r], above_b) = lone_corner_first(a, a_sides);
    let ([u, mut v, mut w], above_a) = lone_corner_first(b, b_sides);
    // Wind both triangles so that each lone corner is above the other's plane.
    if !above_a {
        (q, r) = (r, q);
    }
    if !above_b {
        (v, w) = (w, v);
    }
    match (determinant(q - p, u - p, v - p), determinant(r - p, w - p, u - p)) {
        (Greater, _) | (_, Greater) => Some(false),
        (Less, Less) => Some(true),
        _ => None,
    }
}

/// Rotates a triangle so that the lone corner comes first. Also returns whether that corner is on the upper side.
#[inline]
fn lone_corner_first(&[a, b, c]: &Triangle, sides: [Ordering; 3]) -> (Triangle, bool) {
    let (rotated, side) = if sides[0] == sides[1] {
        ([c, a, b], sides[2])
    } else if sides[0] == sides[2] {
        ([b, c, a], sides[1])
    } else {
        ([a, b, c], sides[0])
    };
    (rotated, side == Greater)
}

/// The sign of the determinant of three differences; `Equal` where it is not certain.
#[inline]
fn determinant(u: DVec3, v: DVec3, w: DVec3) -> Ordering {
    certain_sign(u.cross(v).dot(w), largest(u) * largest(v) * largest(w))
}

/// The error bound of a determinant of three rounded differences, relative to the product of their largest coordinates.
///
/// Each of its six terms is at most that product and is rounded at most eight times: in three differences, two products and
/// three sums. So the error is below `6 * 8` roundings; the rest covers second-order terms.
const RELATIVE: f64 = 52.0 * UNIT_ROUNDOFF;

/// The sign of a determinant, given the product of the largest coordinates of its differences. `Equal` if the error or the
/// range of `f64` leaves it open.
#[inline]
fn certain_sign(determinant: f64, product: f64) -> Ordering {
    // Within these limits, no part of the determinant overflows, and underflow is far below the error.
    const MIN: f64 = power_of_two(-900);
    const MAX: f64 = power_of_two(900);
    let error = product * RELATIVE;
    if determinant.abs() > error && error > MIN && error < MAX {
        if determinant > 0.0 { Greater } else { Less }
    } else {
        Equal
    }
}

#[inline]
fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

#[cfg(test)]
mod rounding_tests;
