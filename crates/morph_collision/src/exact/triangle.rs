use std::cmp::Ordering::{self, Equal};

use glam::DVec3;

use super::filter::{Facet, facets_intersect};
use super::predicates::{Projection, plane_side};
use super::segment::{Segment, all_on_one_side, flat_segment_meets_triangle, lexicographic, segments_intersect};

/// Three corners in any order and winding; they may be on one line, or all the same.
pub type Triangle = [DVec3; 3];

/// Whether two closed triangles share a point: exactly, for any finite coordinates.
///
/// Touching in a single point counts; coplanar triangles and triangles degenerate to a segment or a point are answered like
/// any other. The answer does not depend on the order of the triangles or of their corners. A triangle with a coordinate
/// that is not finite is no set of points and meets nothing.
///
/// Cost: most pairs are decided by [`triangles_intersect_filtered`](crate::triangles_intersect_filtered), the others by
/// adaptive predicates; coordinates beyond about `1e-83` to `1e90` in size take arithmetic in whole numbers.
#[must_use]
pub fn triangles_intersect(a: &Triangle, b: &Triangle) -> bool {
    triangles_intersect_counting(a, b, &mut 0)
}

/// As [`triangles_intersect`]; counts the pairs that the filter leaves open.
#[inline]
pub(crate) fn triangles_intersect_counting(a: &Triangle, b: &Triangle, undecided: &mut u64) -> bool {
    !boxes_apart(a, b) && facets_intersect_counting(&Facet::new(*a), &Facet::new(*b), undecided)
}

/// As [`triangles_intersect_counting`], for triangles whose boxes were compared.
#[inline]
pub(crate) fn facets_intersect_counting(a: &Facet, b: &Facet, undecided: &mut u64) -> bool {
    facets_intersect(a, b).unwrap_or_else(|| {
        *undecided += 1;
        exactly_intersect(&a.corners, &b.corners)
    })
}

/// If the triangles share a point, then an edge of one meets the other: an intersection segment ends where an edge pierces
/// the other triangle, and of two coplanar triangles either edges cross or one holds all edges of the other. So six
/// segment-triangle tests decide, after two planes have rejected most pairs. A corner that both have is the cheapest answer.
#[cold]
fn exactly_intersect(a: &Triangle, b: &Triangle) -> bool {
    if !a.iter().chain(b).all(|corner| corner.is_finite()) {
        return false;
    }
    if a.iter().any(|corner| b.contains(corner)) {
        return true;
    }
    let b_sides = sides(a, b);
    if strictly_one_side(b_sides) {
        return false;
    }
    let a_sides = sides(b, a);
    if strictly_one_side(a_sides) {
        return false;
    }
    edges_meet(b, b_sides, a) || edges_meet(a, a_sides, b)
}

/// Whether the triangles' boxes are apart, which comparisons tell exactly.
#[inline]
fn boxes_apart(a: &Triangle, b: &Triangle) -> bool {
    let (min_a, max_a) = (a[0].min(a[1]).min(a[2]), a[0].max(a[1]).max(a[2]));
    let (min_b, max_b) = (b[0].min(b[1]).min(b[2]), b[0].max(b[1]).max(b[2]));
    min_a.cmpgt(max_b).any() || min_b.cmpgt(max_a).any()
}

/// On which sides of the plane of the first triangle the corners of the second lie; all `Equal` when it spans no plane.
pub(super) fn sides([a, b, c]: &Triangle, points: &Triangle) -> [Ordering; 3] {
    points.map(|p| plane_side(*a, *b, *c, p))
}

/// A projection that keeps the points of a triangle's plane apart; `None` when it spans no plane.
pub(super) fn projection_of([a, b, c]: &Triangle) -> Option<Projection> {
    Projection::keeping_apart(*a, *b, *c)
}

pub(super) fn strictly_one_side(sides: [Ordering; 3]) -> bool {
    sides[0] != Equal && sides[0] == sides[1] && sides[1] == sides[2]
}

/// Whether an edge of `triangle`, whose corners lie on these sides of the plane of `other`, meets `other`.
fn edges_meet(triangle: &Triangle, sides: [Ordering; 3], other: &Triangle) -> bool {
    [(0, 1), (1, 2), (2, 0)]
        .into_iter()
        .any(|(i, j)| segment_meets([triangle[i], triangle[j]], [sides[i], sides[j]], other))
}

/// A segment with its ends on known sides of a triangle's plane.
fn segment_meets([p, q]: Segment, sides: [Ordering; 2], triangle: &Triangle) -> bool {
    let [a, b, c] = *triangle;
    match sides {
        [Equal, Equal] => match projection_of(triangle) {
            Some(projection) => {
                let flat = |point| projection.apply(point);
                flat_segment_meets_triangle([flat(p), flat(q)], triangle.map(flat))
            }
            None => segments_intersect([p, q], hull_of_line(triangle)),
        },
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
