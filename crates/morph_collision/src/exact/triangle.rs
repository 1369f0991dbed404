use std::cmp::Ordering::{self, Equal};

use glam::DVec3;

use super::predicates::{Projection, plane_side};
use super::segment::{Segment, all_on_one_side, flat_segment_meets_triangle, lexicographic, segments_intersect};

/// Three corners in any order and winding; they may be on one line, or all the same.
pub type Triangle = [DVec3; 3];

/// Whether two closed triangles share a point: exactly, for any finite coordinates whose products stay in range.
///
/// Touching in a single point counts; coplanar triangles and triangles degenerate to a segment or a point are answered like
/// any other. The answer does not depend on the order of the triangles or of their corners.
///
/// If the triangles share a point, then an edge of one meets the other: an intersection segment ends where an edge pierces
/// the other triangle, and of two coplanar triangles either edges cross or one holds all edges of the other. So six
/// segment-triangle tests decide, after two planes have rejected most pairs.
#[must_use]
pub fn triangles_intersect(a: &Triangle, b: &Triangle) -> bool {
    let (plane_a, plane_b) = (Plane::of(a), Plane::of(b));
    let b_sides = plane_a.sides(b);
    if strictly_one_side(b_sides) {
        return false;
    }
    let a_sides = plane_b.sides(a);
    if strictly_one_side(a_sides) {
        return false;
    }
    edges_meet(b, b_sides, &plane_a) || edges_meet(a, a_sides, &plane_b)
}

/// A triangle and whether it spans a plane; the projection keeps that plane's points apart.
pub(super) struct Plane<'a> {
    pub(super) triangle: &'a Triangle,
    pub(super) projection: Option<Projection>,
}

impl<'a> Plane<'a> {
    pub(super) fn of(triangle: &'a Triangle) -> Self {
        let [a, b, c] = *triangle;
        Self {
            triangle,
            projection: Projection::keeping_apart(a, b, c),
        }
    }

    /// All `Equal` when the triangle spans no plane.
    pub(super) fn sides(&self, points: &Triangle) -> [Ordering; 3] {
        let [a, b, c] = *self.triangle;
        match self.projection {
            Some(_) => points.map(|p| plane_side(a, b, c, p)),
            None => [Equal; 3],
        }
    }
}

pub(super) fn strictly_one_side(sides: [Ordering; 3]) -> bool {
    sides[0] != Equal && sides[0] == sides[1] && sides[1] == sides[2]
}

/// Whether an edge of `triangle`, whose corners lie on these sides of `plane`, meets the plane's triangle.
fn edges_meet(triangle: &Triangle, sides: [Ordering; 3], plane: &Plane<'_>) -> bool {
    [(0, 1), (1, 2), (2, 0)].into_iter().any(|(i, j)| {
        let edge = [triangle[i], triangle[j]];
        match plane.projection {
            Some(projection) => segment_meets(edge, [sides[i], sides[j]], plane.triangle, projection),
            None => segments_intersect(edge, hull_of_line(plane.triangle)),
        }
    })
}

/// A segment with its ends on known sides of a triangle's plane.
fn segment_meets([p, q]: Segment, sides: [Ordering; 2], triangle: &Triangle, projection: Projection) -> bool {
    let [a, b, c] = *triangle;
    match sides {
        [Equal, Equal] => {
            let flat = |point| projection.apply(point);
            flat_segment_meets_triangle([flat(p), flat(q)], triangle.map(flat))
        }
        [s, t] if s == t => false,
        // The line pierces the plane once; the triangle's edges see it on one side where it does so inside.
        _ => all_on_one_side([plane_side(p, q, a, b), plane_side(p, q, b, c), plane_side(p, q, c, a)]),
    }
}

/// The segment that a degenerate triangle is: its lexicographically first and last corner.
pub(super) fn hull_of_line(triangle: &Triangle) -> Segment {
    let mut corners = *triangle;
    corners.sort_by(|a, b| lexicographic(*a, *b));
    [corners[0], corners[2]]
}
