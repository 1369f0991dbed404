use std::cmp::Ordering::{self, Equal};

use glam::DVec3;

use super::filter::{Facet, facets_intersect};
use super::predicates::{Projection, plane_side};
use super::segment::{Segment, edges, flat_segment_meets_triangle, line_pierces, segments_intersect, sorted};

/// Three corners in any order and winding; they may be on one line, or all equal.
pub type Triangle = [DVec3; 3];

/// Whether two closed triangles share a point: exactly, for any finite coordinates.
///
/// Touching in a single point counts. Coplanar triangles are handled, and so are triangles that degenerate to a segment or a
/// point. The answer does not depend on the order of the triangles or of their corners. A triangle with a coordinate that is
/// not finite is no set of points and meets nothing.
///
/// Cost: a filter in `f64` decides most pairs, and adaptive predicates the others. Coordinates with sizes outside of about
/// `1e-83` to `1e90` take slow exact arithmetic where the filter does not decide.
#[must_use]
pub fn triangles_intersect(a: &Triangle, b: &Triangle) -> bool {
    !boxes_apart(a, b) && facets_intersect_counting(&Facet::new(*a), &Facet::new(*b), &mut 0)
}

/// As [`triangles_intersect`], for triangles with overlapping boxes; counts the pairs that the filter leaves open.
#[inline]
pub(crate) fn facets_intersect_counting(a: &Facet, b: &Facet, undecided: &mut u64) -> bool {
    facets_intersect(a, b).unwrap_or_else(|| {
        *undecided += 1;
        exactly_intersect(&a.corners, &b.corners)
    })
}

/// If the triangles share a point, then an edge of one meets the other: an intersection segment ends where an edge pierces
/// the other triangle, and of two coplanar triangles either edges cross or one contains all edges of the other. So six
/// segment-triangle tests decide, after the two planes have rejected most pairs. A common corner is the cheapest answer.
#[cold]
fn exactly_intersect(a: &Triangle, b: &Triangle) -> bool {
    if !a.iter().chain(b).all(|corner| corner.is_finite()) {
        return false;
    }
    if a.iter().any(|corner| b.contains(corner)) {
        return true;
    }
    sides_of_both(a, b).is_some_and(|[a_sides, b_sides]| edges_meet(b, b_sides, a) || edges_meet(a, a_sides, b))
}

/// Whether the triangles' boxes are apart; comparisons are exact.
#[inline]
fn boxes_apart(a: &Triangle, b: &Triangle) -> bool {
    let (min_a, max_a) = (a[0].min(a[1]).min(a[2]), a[0].max(a[1]).max(a[2]));
    let (min_b, max_b) = (b[0].min(b[1]).min(b[2]), b[0].max(b[1]).max(b[2]));
    min_a.cmpgt(max_b).any() || min_b.cmpgt(max_a).any()
}

/// The sides of the other's plane on which the corners of `a` and of `b` lie, all `Equal` where the other spans no plane;
/// `None` if one of the planes separates the triangles.
pub(super) fn sides_of_both(a: &Triangle, b: &Triangle) -> Option<[[Ordering; 3]; 2]> {
    let sides = |[a, b, c]: &Triangle, points: &Triangle| {
        let sides = points.map(|p| plane_side(*a, *b, *c, p));
        (!strictly_one_side(sides)).then_some(sides)
    };
    let b_sides = sides(a, b)?;
    Some([sides(b, a)?, b_sides])
}

#[inline]
pub(super) fn strictly_one_side(sides: [Ordering; 3]) -> bool {
    sides[0] != Equal && sides[0] == sides[1] && sides[1] == sides[2]
}

/// Whether an edge of `triangle`, whose corners lie on these sides of the plane of `other`, meets `other`.
fn edges_meet(triangle: &Triangle, sides: [Ordering; 3], other: &Triangle) -> bool {
    let mut edges = edges(triangle).into_iter().zip(edges(&sides));
    edges.any(|(edge, sides)| segment_meets(edge, sides, other))
}

/// Whether a segment, whose ends lie on these sides of a triangle's plane, meets the triangle.
fn segment_meets(segment: Segment, sides: [Ordering; 2], triangle: &Triangle) -> bool {
    match sides {
        [Equal, Equal] => match Projection::of_plane(*triangle) {
            Some(projection) => {
                let flat = |point| projection.apply(point);
                flat_segment_meets_triangle(segment.map(flat), triangle.map(flat))
            }
            None => segments_intersect(segment, hull_of_line(triangle)),
        },
        [s, t] => s != t && line_pierces(segment, triangle),
    }
}

/// The segment that a degenerate triangle covers: from its lexicographically first corner to its last.
pub(super) fn hull_of_line(triangle: &Triangle) -> Segment {
    let [first, _, last] = sorted(*triangle);
    [first, last]
}
