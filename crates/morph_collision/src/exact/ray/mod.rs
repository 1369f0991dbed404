//! Whether, where and from which side a ray meets a triangle.

mod line;
mod parameter;

use std::cmp::Ordering::{self, Equal, Greater, Less};

use fearless_simd::Level;
use glam::DVec3;

use super::dyadic::Dyadic;
use super::number::{Approx, Number, UNIT_ROUNDOFF, Vector, cross, cross_coordinate, difference, dot, vector};
use super::predicates::Projection;
use super::segment::{Segment, edges, flat_triangle_contains};
use super::triangle::Triangle;
pub(crate) use line::Line;
use parameter::{height_and_speed, parameter_on_plane};

/// Where a ray first meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// The exact parameter, rounded to the nearest `f64`. So it is the same for all triangles that the ray meets at the same point, and
    /// its order is that of the exact parameters.
    pub(crate) t: f64,
    /// The sign of the direction along the triangle's normal: `Less` for a hit on the front, `Equal` if the triangle is edge-on.
    pub(crate) along_normal: Ordering,
}

/// Whether, where and from which side a ray meets a closed triangle. Exact, except that `t` is rounded.
///
/// The line passes through the triangle iff all edges turn the same way around it. Each turn is a determinant of the direction
/// and of two corners, relative to the origin. Triangles with a common edge share its determinant up to the sign, so no ray slips
/// between them. All three determinants are zero if the ray is in the triangle's plane or the triangle is degenerate.
pub(crate) fn ray_meets_triangle(level: Level, line: &Line, triangle: &Triangle) -> Option<Crossing> {
    let meeting = certain_meeting(line, triangle).unwrap_or_else(|| uncertain_meeting(line, triangle))?;
    let (t, along_normal) = match meeting {
        Meeting::AtOrigin(along_normal) => (0.0, along_normal),
        Meeting::Through(along_normal) => (parameter_on_plane(level, line, triangle), along_normal),
        Meeting::EdgeOn => (edge_on_parameter(line, triangle)?, Equal),
    };
    Some(Crossing { t, along_normal })
}

#[cold]
fn uncertain_meeting(line: &Line, triangle: &Triangle) -> Option<Meeting> {
    meeting::<Approx>(line, triangle).unwrap_or_else(|| meeting::<Dyadic>(line, triangle).flatten())
}

/// How a ray meets a triangle's plane. The first two know the sign of the direction along the normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meeting {
    /// It starts on the triangle.
    AtOrigin(Ordering),
    /// It passes through the triangle.
    Through(Ordering),
    /// It lies in the triangle's plane, or the triangle has none. They may not meet.
    EdgeOn,
}

/// [`meeting`] in plain `f64`, with one error bound per determinant (docs/numerics.md). It decides nearly all rays in general position.
#[inline]
fn certain_meeting(line: &Line, &[a, b, c]: &Triangle) -> Option<Option<Meeting>> {
    const SHARE: f64 = 128.0 * UNIT_ROUNDOFF;
    let size = |v: DVec3| v.abs().max_element();
    // Products of two lengths may underflow before they are multiplied with the reach.
    let sign = |value: f64, magnitude: f64, reach: f64| {
        let is_certain = value.abs() > SHARE * magnitude + f64::MIN_POSITIVE * (1.0 + reach);
        if is_certain { value.partial_cmp(&0.0) } else { None }
    };
    let d = line.direction;
    let [u, v, w] = [a, b, c].map(|corner| corner - line.origin);
    let [of_d, of_u, of_v, of_w] = [d, u, v, w].map(size);
    let turns = [
        sign(d.dot(u.cross(v)), of_d * of_u * of_v, of_d),
        sign(d.dot(v.cross(w)), of_d * of_v * of_w, of_d),
        sign(d.dot(w.cross(u)), of_d * of_w * of_u, of_d),
    ];
    if turns.contains(&Some(Less)) && turns.contains(&Some(Greater)) {
        return Some(None);
    }
    let [Some(turn), Some(_), Some(_)] = turns else {
        return None;
    };
    let (edge, other_edge) = (b - a, c - a);
    let (normal, area) = (edge.cross(other_edge), size(edge) * size(other_edge));
    let height = normal.dot(u);
    if sign(height, area * of_u, of_u)? != turn {
        return Some(None);
    }
    if line.max_t.is_finite() {
        let passed = normal.dot(d) * line.max_t;
        let reach = of_u + of_d * line.max_t;
        if sign(height - passed, area * reach, reach)? == turn {
            return Some(None);
        }
    }
    Some(Some(Meeting::Through(turn)))
}

/// The outer `None` means that the numbers are not exact enough to decide.
#[inline]
fn meeting<N: Number>(line: &Line, triangle: &Triangle) -> Option<Option<Meeting>> {
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
        return Some(Some(Meeting::EdgeOn));
    };
    // The determinants of the turns sum to the speed, so `turn` is the sign of the speed.
    let [height, speed] = height_and_speed::<N>(line, triangle);
    let ahead = height.sign()?;
    if ahead == Equal {
        return Some(Some(Meeting::AtOrigin(turn)));
    }
    if ahead != turn {
        return Some(None);
    }
    if line.max_t.is_finite() {
        let beyond = height.minus(&speed.times(&N::new(line.max_t))).sign()?;
        if beyond == turn {
            return Some(None);
        }
    }
    Some(Some(Meeting::Through(turn)))
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

/// `distance / speed`, rounded to the nearest `f64`, if that is from 0 to `max_t`.
fn parameter(distance: &Dyadic, speed: &Dyadic, max_t: f64) -> Option<f64> {
    let is_beyond = || max_t.is_finite() && is_negative(&speed.times(&Dyadic::new(max_t)).minus(distance), speed);
    // Adding 0 turns a negative zero, from zero over a negative speed, into 0. Otherwise it would sort before other hits at the origin.
    (!is_negative(distance, speed) && !is_beyond()).then(|| distance.over(speed) + 0.0)
}

/// Whether a quotient is negative.
fn is_negative(dividend: &Dyadic, divisor: &Dyadic) -> bool {
    matches!((dividend.order(), divisor.order()), (Less, Greater) | (Greater, Less))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Points of very different sizes, some with few digits.
    pub(super) fn point() -> impl Strategy<Value = DVec3> {
        let coordinate = prop_oneof![(-4_i64..5).prop_map(|x| x as f64), -1.0..1.0, -1e3..1e3, -1e-9..1e-9];
        [coordinate.clone(), coordinate.clone(), coordinate].prop_map(DVec3::from_array)
    }

    pub(super) fn line(origin: DVec3, towards: DVec3) -> Line {
        Line {
            origin,
            direction: (towards - origin) / (towards - origin).abs().max_element(),
            max_t: f64::INFINITY,
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5_000))]
        #[test]
        fn certain_meetings_are_those_of_exact_arithmetic(
            corners in [point(), point(), point()], origin in point(), unit in -200_i32..200, shares in [-0.1..1.0, -0.1..1.0],
            max_t in prop_oneof![Just(f64::INFINITY), 0.0..2.0],
        ) {
            let unit = 2.0_f64.powi(unit);
            let [a, b, c] = corners.map(|corner| corner * unit);
            let line = line(origin * unit, a + (b - a) * shares[0] + (c - a) * shares[1]);
            prop_assume!(line.direction.is_finite());
            let line = Line { max_t: max_t * unit, ..line };
            let exact = meeting::<Dyadic>(&line, &[a, b, c]);
            prop_assert!(certain_meeting(&line, &[a, b, c]).is_none_or(|meeting| Some(meeting) == exact));
            prop_assert!(meeting::<Approx>(&line, &[a, b, c]).is_none_or(|meeting| Some(meeting) == exact));
        }
    }

    #[test]
    fn rays_in_general_position_need_no_exact_arithmetic() {
        use rand::{RngExt, SeedableRng};
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let mut point = |reach: f64| DVec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..reach)));
        let mut open = 0;
        for _ in 0..100_000 {
            let triangle = [point(1.0), point(1.0), point(1.0)];
            let line = line(point(10.0), (triangle[0] + triangle[1] + triangle[2]) / 3.0);
            open += usize::from(parameter::in_double_double(Level::new(), &line, &triangle).is_none());
            open += usize::from(certain_meeting(&line, &triangle).is_none());
        }
        assert_eq!(open, 0);
    }
}
