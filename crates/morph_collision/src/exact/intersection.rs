//! Whether two triangles share a point.

use std::cmp::Ordering::{self, Equal};

use super::filter::{Facet, facets_intersect};
use super::predicates::Projection;
use super::segment::{Segment, edges, flat_segment_meets_triangle, line_pierces, segments_intersect};
use super::separation::certainly_apart;
use super::triangle::{Triangle, hull_of_line, sides_of_both};

/// Whether two closed triangles share a point. The answer is exact for any finite coordinates.
///
/// Touching in a single point counts. Coplanar triangles are handled, and so are triangles that degenerate to a segment or a
/// point. The answer does not depend on the order of the triangles or of their corners. A triangle with a coordinate that is
/// not finite intersects nothing.
///
/// Cost: filters in `f64` decide most pairs, and adaptive predicates decide the others. If the filters do not decide,
/// coordinates with absolute values outside of about `1e-83` to `1e90` take slow exact arithmetic.
#[must_use]
pub fn triangles_intersect(a: &Triangle, b: &Triangle) -> bool {
    !boxes_apart(a, b) && facets_intersect_counting(&Facet::new(*a), &Facet::new(*b), &mut 0)
}

/// Like [`triangles_intersect`], for triangles with overlapping boxes. Adds 1 to `undecided` if exact arithmetic is needed.
#[inline]
pub(crate) fn facets_intersect_counting(a: &Facet, b: &Facet, undecided: &mut u64) -> bool {
    facets_intersect(a, b).unwrap_or_else(|| left_open_intersect(&a.corners, &b.corners, undecided))
}

/// Decides what the filter leaves open. A common corner is the cheapest case, so it is checked first.
#[cold]
fn left_open_intersect(a: &Triangle, b: &Triangle, undecided: &mut u64) -> bool {
    if !a.iter().chain(b).all(|corner| corner.is_finite()) {
        return false;
    }
    if a.iter().any(|corner| b.contains(corner)) {
        return true;
    }
    if certainly_apart(a, b) {
        return false;
    }
    *undecided += 1;
    exactly_intersect(a, b)
}

/// Decides by six segment-triangle tests, after the two planes have rejected most pairs.
///
/// If the triangles share a point, an edge of one meets the other triangle: an intersection segment ends where an edge pierces
/// the other triangle, and if the triangles are coplanar, edges cross or one triangle contains all edges of the other.
fn exactly_intersect(a: &Triangle, b: &Triangle) -> bool {
    sides_of_both(a, b).is_some_and(|[a_sides, b_sides]| edges_meet(b, b_sides, a) || edges_meet(a, a_sides, b))
}

/// Whether the triangles' boxes are disjoint. Comparisons are exact.
#[inline]
fn boxes_apart(a: &Triangle, b: &Triangle) -> bool {
    let (min_a, max_a) = (a[0].min(a[1]).min(a[2]), a[0].max(a[1]).max(a[2]));
    let (min_b, max_b) = (b[0].min(b[1]).min(b[2]), b[0].max(b[1]).max(b[2]));
    min_a.cmpgt(max_b).any() || min_b.cmpgt(max_a).any()
}

/// Whether an edge of `triangle` meets `other`. The corners of `triangle` lie on these sides of `other`'s plane.
fn edges_meet(triangle: &Triangle, sides: [Ordering; 3], other: &Triangle) -> bool {
    let mut edges = edges(triangle).into_iter().zip(edges(&sides));
    edges.any(|(edge, sides)| segment_meets(edge, sides, other))
}

/// Whether a segment meets a triangle. The ends of the segment lie on these sides of the triangle's plane.
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
