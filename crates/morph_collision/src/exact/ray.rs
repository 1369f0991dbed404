use std::cmp::Ordering::{self, Equal, Greater, Less};

use glam::DVec3;

use super::dyadic::Dyadic;
use super::number::{Approx, Number, UNIT_ROUNDOFF, Vector, cross, cross_coordinate, difference, dot, vector};
use super::predicates::Projection;
use super::segment::{Segment, edges, flat_triangle_contains};
use super::triangle::Triangle;

/// The points `origin + t direction` for real `t` from 0 to `max_t`, which may be infinite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) origin: DVec3,
    /// Not zero; its largest coordinate has a size around 1.
    pub(crate) direction: DVec3,
    pub(crate) max_t: f64,
}

/// Where a ray first meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// To a relative error of a few [`VALUE_ERROR`](super::number::VALUE_ERROR)s.
    pub(crate) t: f64,
    /// The sign of the direction along the triangle's normal: `Less` on the front, `Equal` where the triangle is edge-on.
    pub(crate) along_normal: Ordering,
}

/// Whether, where and from which side a ray meets a closed triangle: exactly, up to the roundings of `t`.
///
/// The line passes through the triangle iff all edges turn the same way around it. Each turn is a determinant of the direction
/// and two corners, seen from the origin. Triangles with a common edge share its determinant up to the sign, so no ray slips
/// between them. All three are zero where the ray is in the triangle's plane or the triangle is degenerate.
#[inline]
pub(crate) fn ray_meets_triangle(line: &Line, triangle: &Triangle) -> Option<Crossing> {
    if certainly_misses(line, triangle) {
        return None;
    }
    meets(line, triangle)
}

/// Whether two edges turn in different ways around the line for certain. Decides most triangles.
///
/// The differences, cross products and dot products below round a turn by less than 15 units of `U M^2 |d|`, where `M` is the largest coordinate of a corner seen
/// from the origin and `|d|` the sum of the direction's coordinates. The smallest normal number covers what underflows. Where a turn could overflow, the error
/// is infinite.
#[inline]
fn certainly_misses(line: &Line, triangle: &Triangle) -> bool {
    let direction = line.direction;
    let [u, v, w] = [
        triangle[0] - line.origin,
        triangle[1] - line.origin,
        triangle[2] - line.origin,
    ];
    let reach = u.abs().max(v.abs()).max(w.abs()).max_element();
    let error =
        (1024.0 * reach * reach) * (20.0 / 1024.0 * UNIT_ROUNDOFF) * direction.abs().element_sum() + f64::MIN_POSITIVE;
    let turns = [
        direction.dot(u.cross(v)),
        direction.dot(v.cross(w)),
        direction.dot(w.cross(u)),
    ];
    let least = turns[0].min(turns[1]).min(turns[2]);
    let most = turns[0].max(turns[1]).max(turns[2]);
    least < -error && most > error
}

#[inline(never)]
fn meets(line: &Line, triangle: &Triangle) -> Option<Crossing> {
    crossing::<Approx>(line, triangle).unwrap_or_else(|| crossing::<Dyadic>(line, triangle).flatten())
}

/// The outer `None` says that the numbers are not exact enough to decide.
#[inline]
fn crossing<N: Number>(line: &Line, triangle: &Triangle) -> Option<Option<Crossing>> {
    let [a, b, c] = *triangle;
    let direction: [N; 3] = vector(line.direction);
    let [u, v, w] = triangle.map(|corner| difference::<N>(corner, line.origin));
    let turns = [(&u, &v), (&v, &w), (&w, &u)].map(|(p, q)| dot(&direction, &cross(p, q)).sign());
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

/// The first `t` at which a ray meets a triangle whose plane it is in, or which is a segment or a point; exact decisions.
///
/// The ray starts inside the triangle, or enters through an edge.
#[cold]
fn edge_on_parameter(line: &Line, triangle: &Triangle) -> Option<f64> {
    // The edges alone decide for a degenerate triangle.
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

/// The first `t` at which a ray meets a closed segment in a common plane.
fn segment_parameter(line: &Line, [p, q]: Segment) -> Option<f64> {
    let direction: Vector<Dyadic> = vector(line.direction);
    let (to_p, to_q, edge) = (difference(p, line.origin), difference(q, line.origin), difference(q, p));
    for axis in 0..3 {
        let speed = cross_coordinate(&direction, &edge, axis);
        if speed.order() == Equal {
            continue;
        }
        // Not parallel in this projection, and so not in space: they meet if the ends are on different sides of the line.
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

/// `distance / speed` if that is in 0..=`max_t`.
fn parameter(distance: &Dyadic, speed: &Dyadic, max_t: f64) -> Option<f64> {
    let is_beyond = || max_t.is_finite() && is_negative(&speed.times(&Dyadic::new(max_t)).minus(distance), speed);
    (!is_negative(distance, speed) && !is_beyond()).then(|| distance.over(speed))
}

/// Whether a quotient is negative.
fn is_negative(dividend: &Dyadic, divisor: &Dyadic) -> bool {
    matches!((dividend.order(), divisor.order()), (Less, Greater) | (Greater, Less))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::exact::number::power_of_two;

    #[test]
    fn what_certainly_misses_misses_exactly_and_most_misses_are_certain() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let (mut certain, mut far_misses, mut doubtful) = (0, 0, 0);
        for case in 0..40_000 {
            let scale = power_of_two([0, 0, -300, 400, 506, 511, -505][case % 7]);
            let mut vector = || DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
            let (a, b, c, origin) = (vector(), vector(), vector(), vector());
            // Every other ray passes an edge within a few roundings.
            let target = if case % 2 == 0 { 0.3 * a + 0.7 * b } else { vector() };
            let direction = target - origin;
            let line = Line {
                origin: origin * scale,
                direction,
                max_t: f64::INFINITY,
            };
            let triangle = [a, b, c].map(|corner| corner * scale);
            let misses = crossing::<Dyadic>(&line, &triangle).flatten().is_none();
            let is_certain = certainly_misses(&line, &triangle);
            assert!(misses || !is_certain, "case {case}");
            if case % 2 == 1 && scale < power_of_two(500) && scale > power_of_two(-500) {
                // The line misses too.
                far_misses += u32::from(
                    misses && {
                        let back = Line {
                            direction: -direction,
                            ..line
                        };
                        crossing::<Dyadic>(&back, &triangle).flatten().is_none()
                    },
                );
                certain += u32::from(is_certain);
            }
            doubtful += u32::from(case % 2 == 0 && !is_certain);
        }
        assert!(certain > 10_000 && certain == far_misses, "{certain} of {far_misses}");
        assert!(doubtful > 10_000, "{doubtful}");
    }
}
