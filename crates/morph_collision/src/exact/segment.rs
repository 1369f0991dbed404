//! Tests closed segments against closed segments and triangles.

use std::cmp::Ordering::{self, Equal};

use glam::{DVec2, DVec3};

use super::predicates::{Projection, line_side, plane_side};

/// A closed segment; a point if both ends are equal.
pub(crate) type Segment = [DVec3; 2];

/// The edges of a triangle, in order.
#[inline]
pub(crate) fn edges<T: Copy>(&[a, b, c]: &[T; 3]) -> [[T; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Whether two segments in space share a point.
pub(crate) fn segments_intersect([p, q]: Segment, [u, v]: Segment) -> bool {
    if plane_side(p, q, u, v) != Equal {
        return false;
    }
    let triples = [[p, q, u], [p, q, v], [u, v, p], [u, v, q]];
    match triples.into_iter().find_map(Projection::of_plane) {
        Some(projection) => {
            let [p, q, u, v] = [p, q, u, v].map(|point| projection.apply(point));
            flat_segments_intersect([p, q], [u, v])
        }
        // All four points are on one line, or both segments are points. The lexicographic order is the order along the line.
        None => {
            let ([p, q], [u, v]) = (sorted([p, q]), sorted([u, v]));
            lexicographic(&p, &v).is_le() && lexicographic(&u, &q).is_le()
        }
    }
}

/// Whether a segment and a non-degenerate triangle share a point, both projected from the same plane.
pub(crate) fn flat_segment_meets_triangle(segment: [DVec2; 2], triangle: [DVec2; 3]) -> bool {
    flat_triangle_contains(&triangle, segment[0])
        || edges(&triangle)
            .into_iter()
            .any(|edge| flat_segments_intersect(segment, edge))
}

/// Whether a point is in a non-degenerate triangle, both projected from the same plane.
pub(crate) fn flat_triangle_contains(triangle: &[DVec2; 3], p: DVec2) -> bool {
    all_on_one_side(edges(triangle).map(|[a, b]| line_side(a, b, p)))
}

/// Whether a line that crosses a triangle's plane, but is not in it, meets the triangle. It does if all edges pass it on the same
/// side.
pub(crate) fn line_pierces([p, q]: Segment, triangle: &[DVec3; 3]) -> bool {
    all_on_one_side(edges(triangle).map(|[a, b]| plane_side(p, q, a, b)))
}

/// Whether no two signs are opposite. Zero agrees with both.
fn all_on_one_side(sides: [Ordering; 3]) -> bool {
    sides.iter().all(|side| side.is_ge()) || sides.iter().all(|side| side.is_le())
}

/// Whether two segments cross in a point that is not an end of either.
pub(crate) fn flat_segments_cross([p, q]: [DVec2; 2], [u, v]: [DVec2; 2]) -> bool {
    let opposite = |s: Ordering, t: Ordering| s != Equal && s == t.reverse();
    opposite(line_side(u, v, p), line_side(u, v, q)) && opposite(line_side(p, q, u), line_side(p, q, v))
}

fn flat_segments_intersect(s @ [p, q]: [DVec2; 2], t @ [u, v]: [DVec2; 2]) -> bool {
    let contains = |[a, b]: [DVec2; 2], point| {
        line_side(a, b, point) == Equal && a.min(b).cmple(point).all() && point.cmple(a.max(b)).all()
    };
    flat_segments_cross(s, t) || contains(t, p) || contains(t, q) || contains(s, u) || contains(s, v)
}

pub(crate) fn lexicographic(a: &DVec3, b: &DVec3) -> Ordering {
    a.to_array().partial_cmp(&b.to_array()).unwrap_or(Equal)
}

/// Sorts points lexicographically.
pub(crate) fn sorted<const N: usize>(mut points: [DVec3; N]) -> [DVec3; N] {
    points.sort_by(lexicographic);
    points
}
