//! Most pairs of triangles are decided here: in `f64`, with a bound on what rounding can have done.

use std::cmp::Ordering::{self, Equal, Greater, Less};

use glam::DVec3;

use super::Triangle;

/// Whether two closed triangles share a point; `None` where a determinant is too close to zero to be sure of its sign.
///
/// What it says is what [`triangles_intersect`](crate::triangles_intersect) says. Triangles that touch, or are coplanar or
/// degenerate, are never decided here unless one lies wholly beyond the other's plane; of pairs in general position nearly
/// all are. Cost: two normals, six heights, and two determinants where the triangles reach through each other's planes.
///
/// With all corners off the other's plane, each triangle has one corner alone on its side, and meets the planes' common
/// line between the two edges from there; the intervals overlap iff two determinants of an edge of each say so (Guigue and
/// Devillers 2003).
#[must_use]
#[inline]
pub fn triangles_intersect_filtered(a: &Triangle, b: &Triangle) -> Option<bool> {
    facets_intersect(&Facet::new(*a), &Facet::new(*b))
}

/// A triangle with what the filter needs of it in every pair.
#[derive(Clone, Debug)]
pub(crate) struct Facet {
    pub(crate) corners: Triangle,
    plane: Plane,
}

impl Facet {
    #[inline]
    pub(crate) fn new(corners: Triangle) -> Self {
        Self {
            plane: Plane::of(&corners),
            corners,
        }
    }
}

#[inline]
pub(super) fn facets_intersect(
    Facet {
        corners: a,
        plane: a_plane,
    }: &Facet,
    Facet {
        corners: b,
        plane: b_plane,
    }: &Facet,
) -> Option<bool> {
    let b_sides = a_plane.sides(b);
    if strictly_one_side(b_sides) {
        return Some(false);
    }
    let a_sides = b_plane.sides(a);
    if strictly_one_side(a_sides) {
        return Some(false);
    }
    if a_sides.contains(&Equal) || b_sides.contains(&Equal) {
        return None;
    }
    let ([p, mut q, mut r], above_b) = lone_corner_first(a, a_sides);
    let ([u, mut v, mut w], above_a) = lone_corner_first(b, b_sides);
    // Turned so that each lone corner is above the other's plane.
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

fn strictly_one_side(sides: [Ordering; 3]) -> bool {
    sides[0] != Equal && sides[0] == sides[1] && sides[1] == sides[2]
}

/// The plane through a triangle.
#[derive(Clone, Debug)]
struct Plane {
    origin: DVec3,
    normal: DVec3,
    /// The product of the largest coordinates of the two edges that the normal is of.
    size: f64,
}

impl Plane {
    #[inline]
    fn of([a, b, c]: &Triangle) -> Self {
        let (u, v) = (*b - *a, *c - *a);
        Self {
            origin: *a,
            normal: u.cross(v),
            size: largest(u) * largest(v),
        }
    }

    /// On which sides some corners lie; `Equal` where that is not certain.
    #[inline]
    fn sides(&self, [a, b, c]: &Triangle) -> [Ordering; 3] {
        [self.side(*a), self.side(*b), self.side(*c)]
    }

    #[inline]
    fn side(&self, corner: DVec3) -> Ordering {
        let to = corner - self.origin;
        certain_sign(self.normal.dot(to), self.size * largest(to))
    }
}

/// The sign of the determinant of three differences; `Equal` where it is not certain.
#[inline]
fn determinant(u: DVec3, v: DVec3, w: DVec3) -> Ordering {
    certain_sign(u.cross(v).dot(w), largest(u) * largest(v) * largest(w))
}

/// The error of a determinant of three rounded differences, at most, per product of their largest coordinates.
///
/// Each of its six terms is at most that product and is rounded at most eight times: in three differences, two products and
/// three sums. So it is off by less than `6 * 8 * 2^-53` products.
const RELATIVE: f64 = 52.0 * (f64::EPSILON / 2.0);

/// The sign of a determinant of three rounded differences whose largest coordinates have this product; `Equal` where its error, or
/// the range of `f64`, leaves it open.
#[inline]
fn certain_sign(determinant: f64, product: f64) -> Ordering {
    const LEAST: f64 = f64::from_bits((1023 - 900) << 52);
    const MOST: f64 = f64::from_bits((1023 + 900) << 52);
    let error = product * RELATIVE;
    if determinant.abs() > error && error > LEAST && error < MOST {
        if determinant > 0.0 { Greater } else { Less }
    } else {
        Equal
    }
}

#[inline]
fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// A triangle turned so that the corner that is alone on its side comes first, and whether that is the upper side.
#[inline]
fn lone_corner_first(&[a, b, c]: &Triangle, sides: [Ordering; 3]) -> (Triangle, bool) {
    let (turned, side) = if sides[0] == sides[1] {
        ([c, a, b], sides[2])
    } else if sides[0] == sides[2] {
        ([b, c, a], sides[1])
    } else {
        ([a, b, c], sides[0])
    };
    (turned, side == Greater)
}

#[cfg(test)]
mod rounding_tests;
