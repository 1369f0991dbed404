//! A ray in the plane of a triangle, or against one that is only a segment or a point.

use std::cmp::Ordering::{Equal, Greater, Less};

use glam::DVec3;

use super::Triangle;
use super::dyadic::Dyadic;
use super::number::{Number, Vector, cross_coordinate, difference, vector};
use super::predicates::{Projection, line_side};
use super::ray::{Crossing, Line};
use super::segment::all_on_one_side;

/// The first point that a ray shares with a triangle whose edges it all meets or passes in their planes; exact.
///
/// In the triangle's plane the ray starts inside, or it enters through an edge.
#[cold]
pub(super) fn edge_on(line: &Line, triangle: &Triangle) -> Option<Crossing> {
    let [a, b, c] = *triangle;
    let first = if starts_inside(line.origin, triangle) {
        Some(0.0)
    } else {
        [(a, b), (b, c), (c, a)]
            .into_iter()
            .filter_map(|(p, q)| segment(line, p, q))
            .min_by(f64::total_cmp)
    };
    first.map(|t| Crossing { t, along_normal: Equal })
}

/// For an origin in the triangle's plane, as it is for a line that meets or passes all three edges in their planes; `false` for a
/// triangle without a plane, whose edges speak for it.
fn starts_inside(origin: DVec3, triangle: &Triangle) -> bool {
    let [a, b, c] = *triangle;
    let Some(projection) = Projection::keeping_apart(a, b, c) else {
        return false;
    };
    let [a, b, c, o] = [a, b, c, origin].map(|p| projection.apply(p));
    all_on_one_side([line_side(a, b, o), line_side(b, c, o), line_side(c, a, o)])
}

/// Where a ray first meets a closed segment in one plane with it.
fn segment(line: &Line, p: DVec3, q: DVec3) -> Option<f64> {
    let direction: Vector<Dyadic> = vector(line.direction);
    let (to_p, to_q, edge) = (difference(p, line.origin), difference(q, line.origin), difference(q, p));
    for axis in 0..3 {
        let speed = cross_coordinate(&direction, &edge, axis);
        if speed.order() == Equal {
            continue;
        }
        // Not parallel, in this projection and so in space: they meet if the line has the ends on different sides.
        let sides = [&to_p, &to_q].map(|to| cross_coordinate(&direction, to, axis).order());
        if sides[0] == sides[1] {
            return None;
        }
        return parameter(&cross_coordinate(&to_p, &edge, axis), &speed, line.max_t);
    }
    let off_the_line = |to: &Vector<Dyadic>| (0..3).any(|i| cross_coordinate(&direction, to, i).order() != Equal);
    if off_the_line(&to_p) {
        return None;
    }
    let axis = line.direction.abs().max_position();
    let speed = &direction[axis];
    let ends = [&to_p[axis], &to_q[axis]];
    let (behind, beyond) = (
        ends.map(|end| is_behind(end, speed)),
        ends.map(|end| is_beyond(end, speed, line.max_t)),
    );
    if behind == [true; 2] || beyond == [true; 2] {
        return None;
    }
    if behind[0] || behind[1] {
        return Some(0.0);
    }
    let [t_p, t_q] = ends.map(|end| end.over(speed));
    Some(t_p.min(t_q))
}

/// `distance / speed` if it lies within 0 and `max_t`.
fn parameter(distance: &Dyadic, speed: &Dyadic, max_t: f64) -> Option<f64> {
    let inside = !is_behind(distance, speed) && !is_beyond(distance, speed, max_t);
    inside.then(|| distance.over(speed))
}

/// Whether `distance / speed` is below 0.
fn is_behind(distance: &Dyadic, speed: &Dyadic) -> bool {
    matches!((distance.order(), speed.order()), (Less, Greater) | (Greater, Less))
}

/// Whether `distance / speed` is above `max_t`.
fn is_beyond(distance: &Dyadic, speed: &Dyadic, max_t: f64) -> bool {
    max_t.is_finite() && {
        let rest = speed.times(&Dyadic::new(max_t)).minus(distance);
        is_behind(&rest, speed)
    }
}
