//! Closest points in `f64`: not exact, but the points lie on what they are said to lie on, and their distance is too large
//! by a few roundings of the coordinates at most, for triangles and segments of any shape.

use glam::DVec3;

use super::Triangle;
use super::closest::closest_on_triangle;
use super::segment::Segment;

/// The point of a segment closest to `point`.
pub(crate) fn closest_on_segment(point: DVec3, [p, q]: Segment) -> DVec3 {
    let along = q - p;
    let t = (point - p).dot(along) / along.length_squared();
    // Not a number for a segment that is a point.
    if t > 0.0 { lerp([p, q], t.min(1.0)) } else { p }
}

/// The closest points of two segments, one on each.
pub(crate) fn closest_of_segments(s: Segment, t: Segment) -> (DVec3, DVec3) {
    let mut best = Nearest::default();
    for p in s {
        best.offer(p, closest_on_segment(p, t));
    }
    for q in t {
        best.offer(closest_on_segment(q, s), q);
    }
    // Between the ends, where the lines are closest: by Cramer's rule, when it leads inside the first segment.
    let (d, e, r) = (s[1] - s[0], t[1] - t[0], t[0] - s[0]);
    let (dd, de, ee) = (d.length_squared(), d.dot(e), e.length_squared());
    let along = (r.dot(d) * ee - r.dot(e) * de) / (dd * ee - de * de);
    if along > 0.0 && along < 1.0 {
        let q = closest_on_segment(lerp(s, along), t);
        best.offer(closest_on_segment(q, s), q);
    }
    best.points()
}

/// The closest points of a segment and a triangle that does not cross it, in this order.
pub(crate) fn closest_of_segment_and_triangle(segment: Segment, triangle: &Triangle) -> (DVec3, DVec3) {
    if segment[0] == segment[1] {
        return (segment[0], closest_on_triangle(segment[0], triangle).point);
    }
    let mut best = Nearest::default();
    for p in segment {
        best.offer(p, closest_on_triangle(p, triangle).point);
    }
    for edge in edges(triangle) {
        let (p, q) = closest_of_segments(segment, edge);
        best.offer(p, q);
    }
    best.points()
}

/// The unit normal by the right hand; zero for a triangle without area. A sliver's is as uncertain as its shape.
pub(crate) fn unit_normal([a, b, c]: &Triangle) -> DVec3 {
    let (u, v) = (b - a, c - a);
    // Scaled first, so that tiny and huge triangles have a normal like any other.
    let size = u.abs().max(v.abs()).max_element();
    if size == 0.0 {
        return DVec3::ZERO;
    }
    (u / size).cross(v / size).normalize_or_zero()
}

pub(crate) fn edges([a, b, c]: &Triangle) -> [Segment; 3] {
    [[*a, *b], [*b, *c], [*c, *a]]
}

/// A point of the segment for `t` in 0..=1, reckoned from the nearer end.
pub(crate) fn lerp([p, q]: Segment, t: f64) -> DVec3 {
    if t <= 0.5 {
        p + (q - p) * t
    } else {
        q + (p - q) * (1.0 - t)
    }
}

/// The closest of the pairs of points offered.
#[derive(Default)]
pub(crate) struct Nearest(Option<(f64, DVec3, DVec3)>);

impl Nearest {
    pub(crate) fn offer(&mut self, p: DVec3, q: DVec3) {
        let distance = p.distance_squared(q);
        if self.0.is_none_or(|(best, ..)| distance < best) {
            self.0 = Some((distance, p, q));
        }
    }

    /// Two zeros before any offer.
    pub(crate) fn points(&self) -> (DVec3, DVec3) {
        self.0.map_or((DVec3::ZERO, DVec3::ZERO), |(_, p, q)| (p, q))
    }
}
