//! The parameter at which a ray passes through a plane, rounded correctly.

use glam::DVec3;

use super::line::Line;
use crate::exact::double_double::{DoubleDouble, UNDERFLOW};
use crate::exact::dyadic::Dyadic;
use crate::exact::number::{Number, UNIT_ROUNDOFF, cross, difference, dot, vector};
use crate::exact::triangle::Triangle;

/// The height of a triangle's plane over the ray's origin and the ray's speed towards it, both times the length of the normal. Their
/// quotient is the parameter at which the ray meets the plane.
#[inline]
pub(super) fn height_and_speed<N: Number>(line: &Line, &[a, b, c]: &Triangle) -> [N; 2] {
    let normal = cross(&difference::<N>(b, a), &difference::<N>(c, a));
    [
        dot(&normal, &difference(a, line.origin)),
        dot(&normal, &vector(line.direction)),
    ]
}

/// The `t` at which a ray passes through a triangle's plane, rounded to the nearest `f64`.
pub(super) fn parameter_on_plane(line: &Line, triangle: &Triangle) -> f64 {
    in_double_double(line, triangle).unwrap_or_else(|| {
        let [height, speed] = height_and_speed::<Dyadic>(line, triangle);
        height.over(&speed)
    })
}

/// `None` if it is not certain which `f64` is nearest. That is very rare.
///
/// With `n` for the normal and `u` for the way from the origin to a corner, a rounded parameter `q` is corrected by `n (u - q d) / n d`.
/// docs/numerics.md derives the error of the correction.
pub(super) fn in_double_double(line: &Line, &[a, b, c]: &Triangle) -> Option<f64> {
    const V: f64 = UNIT_ROUNDOFF;
    let way = |to: DVec3, from: DVec3| [0, 1, 2].map(|axis| DoubleDouble::difference(to[axis], from[axis]));
    let high = |v: &[DoubleDouble; 3]| DVec3::from_array(v.map(|coordinate| coordinate.high));
    let (edge, other_edge, to_plane) = (way(b, a), way(c, a), way(a, line.origin));
    let normal: [DoubleDouble; 3] = std::array::from_fn(|axis| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        edge[i].times(other_edge[j]).minus(edge[j].times(other_edge[i]))
    });
    let speed = high(&normal).dot(line.direction);
    let nearly = high(&normal).dot(high(&to_plane)) / speed;
    let rest: [DoubleDouble; 3] = std::array::from_fn(|axis| {
        let passed = DoubleDouble::product(nearly, line.direction[axis]);
        normal[axis].times(to_plane[axis].minus(passed))
    });
    let rest = rest[0].plus(rest[1]).plus(rest[2]);
    let correction = rest.high / speed;

    let size = |v: &[DoubleDouble; 3]| high(v).abs().max_element();
    let area = size(&edge) * size(&other_edge);
    let reach = size(&to_plane) + nearly.abs() * line.direction.abs().max_element();
    let rest_error = 256.0 * V * V * area * reach + 64.0 * UNDERFLOW * (1.0 + reach + area);
    let speed_error = 64.0 * V * area * line.direction.abs().max_element() + 64.0 * UNDERFLOW;
    let least_speed = speed.abs() - speed_error;
    let error = 2.0 * (rest_error + correction.abs() * speed_error) / least_speed + 8.0 * V * correction.abs();
    // Rounding is monotonic: between two numbers that are rounded to the same `f64`, all others are, too.
    let [lowest, highest] = [correction - error, correction + error].map(|correction| nearly + correction);
    (least_speed > 0.0 && lowest == highest).then_some(lowest)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::tests::{line, point};
    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]
        #[test]
        fn parameters_are_rounded_like_exact_ones(
            corners in [point(), point(), point()], origin in point(), unit in -60_i32..60, shares in [0.0..1.0, 0.0..1.0],
        ) {
            let unit = 2.0_f64.powi(unit);
            let [a, b, c] = corners.map(|corner| corner * unit);
            let line = line(origin * unit, a + (b - a) * shares[0] + (c - a) * shares[1]);
            prop_assume!(line.direction.is_finite());
            if let Some(t) = in_double_double(&line, &[a, b, c]) {
                let [height, speed] = height_and_speed::<Dyadic>(&line, &[a, b, c]);
                prop_assert_eq!(t, height.over(&speed));
            }
        }
    }

    #[test]
    fn a_parameter_halfway_between_two_f64s_and_one_out_of_range_need_exact_arithmetic() {
        let wall = |z: f64| {
            [
                DVec3::new(-1.0, -1.0, z),
                DVec3::new(3.0, -1.0, z),
                DVec3::new(-1.0, 3.0, z),
            ]
        };
        let ray = |z: f64| Line {
            origin: DVec3::new(0.0, 0.0, z),
            direction: DVec3::Z,
            max_t: f64::INFINITY,
        };
        let halfway = (wall(1.0), ray(-0.5 * f64::EPSILON));
        assert_eq!(in_double_double(&halfway.1, &halfway.0), None);
        assert_eq!(parameter_on_plane(&halfway.1, &halfway.0), 1.0);
        let tiny = wall(1e-320).map(|corner| DVec3::new(1e-200, 1e-200, 1.0) * corner);
        assert_eq!(in_double_double(&ray(0.0), &tiny), None);
        assert_eq!(parameter_on_plane(&ray(0.0), &tiny), 1e-320);
    }
}
