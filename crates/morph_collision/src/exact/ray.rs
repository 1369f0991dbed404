use std::cmp::Ordering::{self, Equal, Greater, Less};

use glam::DVec3;

use super::dyadic::Dyadic;
use super::number::{Approx, Number, Vector, cross, cross_coordinate, difference, dot, vector};
use super::predicates::Projection;
use super::segment::{Segment, edges, flat_triangle_contains};
use super::triangle::Triangle;

/// The points `origin + t direction` for real `t` from 0 to `max_t`, which may be infinite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) origin: DVec3,
    /// Not zero; its largest absolute coordinate is around 1.
    pub(crate) direction: DVec3,
    pub(crate) max_t: f64,
}

/// Where a ray first meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// With a relative error of a few [`VALUE_ERROR`](super::number::VALUE_ERROR)s.
    pub(crate) t: f64,
    /// The sign of the direction along the triangle's normal: `Less` for a hit on the front, `Equal` if the triangle is edge-on.
    pub(crate) along_normal: Ordering,
}

/// Whether, where and from which side a ray meets a closed triangle. Exact, except for the roundings of `t`.
///
/// The line passes through the triangle iff all edges turn the same way around it. Each turn is a determinant of the direction
/// and of two corners, relative to the origin. Triangles with a common edge share its determinant up to the sign, so no ray slips
/// between them. All three determinants are zero if the ray is in the triangle's plane or the triangle is degenerate.
pub(crate) fn ray_meets_triangle(line: &Line, triangle: &Triangle) -> Option<Crossing> {
    crossing::<Approx>(line, triangle).unwrap_or_else(|| crossing::<Dyadic>(line, triangle).flatten())
}

/// The outer `None` means that the numbers are not exact enough to decide.
#[inline]
fn crossing<N: Number>(line: &Line, triangle: &Triangle) -> Option<Option<Crossing>> {
    let [a, b, c] = *triangle;
    let direction: [N; 3] = vector(line.direction);
    let u: [N; 3] = difference(a, line.origin);
    let v: [N; 3] = difference(b, line.origin);
    let w: [N; 3] = difference(c, line.origin);
    let turns = [
        dot(&direction, &cross(&u, &v)).sign(),
        dot(&direction, &cross(&v, &w)).sign(),
        dot(&direction, &cross(&w, &u)).sign(),
    ];
    if turns.contains(&Some(Less)) && turns.contains(&Some(Greater)) {
        return Some(None);
    }
    let turns = [turns[0]?, turns[1]?, turns[2]?];
    let Some(&turn) = turns.iter().find(|turn| **turn != Equal) else {
        let t = edge_on_parameter(line, triangle);
        return Some(t.map(|t| Crossing { t, along_normal: Equal }));
    };
    let normal = cross(&difference::<N>(b, a), &difference::<N>(c, a));
    // The determinants of the turns sum to the speed, so `turn` is the sign of the speed.
    let (height, speed) = (dot(&normal, &u), dot(&normal, &direction));
    let ahead = height.sign()?;
    if ahead != Equal && ahead != turn {
        return Some(None);
    }
    if line.max_t.is_finite() {
        let beyond = height.minus(&speed.times(&N::new(line.max_t))).sign()?;
        if beyond == turn {
            return Some(None);
        }
    }
    Some(Some(Crossing {
        t: if ahead == Equal { 0.0 } else { height.ratio(&speed)? },
        along_normal: turn,
    }))
}

/// The first `t` at which a ray meets a triangle, if the ray is in the triangle's plane or the triangle is a segment or a point.
/// Decisions are exact.
///
/// A ray that meets the triangle starts inside it or enters through an edge.
#[cold]
fn edge_on_parameter(line: &Line, triangle: &Triangle) -> Option<f64> {
    // For a degenerate triangle, only the edges matter.
    let starts_inside = Projection::of_plane(*triangle).is_some_and(|projection| {
        let flat = |point| projection.apply(point);
        flat_triangle_contains(&triangle.map(flat), flat(line.origin))
    });
    if starts_inside {
        return Some(0.0);
    }
    let entries = edges(triangle)
        .into_iter()
        .filter_map(|edge| segment_parameter(line, edge));
    entries.min_by(f64::total_cmp)
}

/// The first `t` at which a ray meets a closed segment that is coplanar with it.
fn segment_parameter(line: &Line, [p, q]: Segment) -> Option<f64> {
    let direction: Vector<Dyadic> = vector(line.direction);
    let (to_p, to_q, edge) = (difference(p, line.origin), difference(q, line.origin), difference(q, p));
    for axis in 0..3 {
        let speed = cross_coordinate(&direction, &edge, axis);
        if speed.order() == Equal {
            continue;
        }
        // Not parallel in this projection, so not parallel in space. They meet if the ends are on different sides of the line.
        let sides = [&to_p, &to_q].map(|to| cross_coordinate(&direction, to, axis).order());
        if sides[0] == sides[1] {
            return None;
        }
        return parameter(&cross_coordinate(&to_p, &edge, axis), &speed, line.max_t);
    }
    // Parallel: they meet only if the segment is on the line.
    if cross(&direction, &to_p).iter().any(|side| side.order() != Equal) {
        return None;
    }
    let axis = line.direction.abs().max_position();
    let speed = &direction[axis];
    let ends = [&to_p[axis], &to_q[axis]];
    if is_negative(ends[0], speed) != is_negative(ends[1], speed) {
        return Some(0.0);
    }
    let parameters = ends.into_iter().filter_map(|end| parameter(end, speed, line.max_t));
    parameters.min_by(f64::total_cmp)
}

/// `distance / speed` if that is from 0 to `max_t`.
fn parameter(distance: &Dyadic, speed: &Dyadic, max_t: f64) -> Option<f64> {
    let is_beyond = || max_t.is_finite() && is_negative(&speed.times(&Dyadic::new(max_t)).minus(distance), speed);
    // Adding 0 turns a negative zero, from zero over a negative speed, into 0. Otherwise it would sort before other hits at the origin.
    (!is_negative(distance, speed) && !is_beyond()).then(|| distance.over(speed) + 0.0)
}

/// Whether a quotient is negative.
fn is_negative(dividend: &Dyadic, divisor: &Dyadic) -> bool {
    matches!((dividend.order(), divisor.order()), (Less, Greater) | (Greater, Less))
}
