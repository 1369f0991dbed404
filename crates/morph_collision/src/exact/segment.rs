//! Closed segments against closed segments and triangles.

use std::cmp::Ordering::{self, Equal};

use glam::{DVec2, DVec3};

use super::predicates::{Projection, line_side, plane_side};

/// A closed segment; a point when both ends agree.
pub(crate) type Segment = [DVec3; 2];

/// Whether two coplanar-or-not segments share a point.
pub(crate) fn segments_intersect([p, q]: Segment, [u, v]: Segment) -> bool {
    if plane_side(p, q, u, v) != Equal {
        return false;
    }
    let triples = [(p, q, u), (p, q, v), (u, v, p), (u, v, q)];
    match triples
        .into_iter()
        .find_map(|(a, b, c)| Projection::keeping_apart(a, b, c))
    {
        Some(projection) => {
            let [p, q, u, v] = [p, q, u, v].map(|point| projection.apply(point));
            flat_segments_intersect([p, q], [u, v])
        }
        // All four on one line, or both segments are points: order along the line is lexicographic order.
        None => {
            let ([p, q], [u, v]) = (sorted([p, q]), sorted([u, v]));
            lexicographic(p, v).is_le() && lexicographic(u, q).is_le()
        }
    }
}

/// Whether a segment and a triangle that is not degenerate share a point, both in the projection's plane.
pub(crate) fn flat_segment_meets_triangle(segment: [DVec2; 2], [a, b, c]: [DVec2; 3]) -> bool {
    let p = segment[0];
    let sides = [line_side(a, b, p), line_side(b, c, p), line_side(c, a, p)];
    all_on_one_side(sides)
        || flat_segments_intersect(segment, [a, b])
        || flat_segments_intersect(segment, [b, c])
        || flat_segments_intersect(segment, [c, a])
}

/// No two signs contradict each other; zero agrees with both.
pub(crate) fn all_on_one_side(sides: [Ordering; 3]) -> bool {
    sides.iter().all(|side| side.is_ge()) || sides.iter().all(|side| side.is_le())
}

/// Whether two segments cross in a point that is an end of neither.
pub(crate) fn flat_segments_cross([p, q]: [DVec2; 2], [u, v]: [DVec2; 2]) -> bool {
    let apart = |s: Ordering, t: Ordering| s != Equal && t != Equal && s != t;
    apart(line_side(u, v, p), line_side(u, v, q)) && apart(line_side(p, q, u), line_side(p, q, v))
}

fn flat_segments_intersect([p, q]: [DVec2; 2], [u, v]: [DVec2; 2]) -> bool {
    let (up, uq) = (line_side(u, v, p), line_side(u, v, q));
    let (pu, pv) = (line_side(p, q, u), line_side(p, q, v));
    let apart = |s: Ordering, t: Ordering| s != Equal && t != Equal && s != t;
    (apart(up, uq) && apart(pu, pv))
        || (up == Equal && in_box(p, u, v))
        || (uq == Equal && in_box(q, u, v))
        || (pu == Equal && in_box(u, p, q))
        || (pv == Equal && in_box(v, p, q))
}

/// For a point on the line through `a` and `b`: whether it lies between them.
fn in_box(point: DVec2, a: DVec2, b: DVec2) -> bool {
    a.min(b).cmple(point).all() && point.cmple(a.max(b)).all()
}

pub(crate) fn lexicographic(a: DVec3, b: DVec3) -> Ordering {
    a.to_array().partial_cmp(&b.to_array()).unwrap_or(Equal)
}

pub(crate) fn sorted([p, q]: Segment) -> Segment {
    if lexicographic(p, q).is_le() { [p, q] } else { [q, p] }
}
