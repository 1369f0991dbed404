//! The parameter at which a ray passes through a plane, rounded correctly.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f64x4};
use glam::{DVec3, Vec3Swizzles};

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
pub(super) fn parameter_on_plane(level: Level, line: &Line, triangle: &Triangle) -> f64 {
    in_double_double(level, line, triangle).unwrap_or_else(|| exactly(line, triangle))
}

#[cold]
fn exactly(line: &Line, triangle: &Triangle) -> f64 {
    let [height, speed] = height_and_speed::<Dyadic>(line, triangle);
    height.over(&speed)
}

/// `None` if it is not certain which `f64` is nearest. That is very rare.
#[inline]
pub(super) fn in_double_double(level: Level, line: &Line, triangle: &Triangle) -> Option<f64> {
    dispatch!(level, simd => rounded(simd, line, triangle))
}

/// With `n` for the normal and `u` for the way from the origin to a corner, a rounded parameter `q` is corrected by `n (u - q d) / n d`.
/// docs/numerics.md derives the error of the correction. The three axes are side by side.
#[inline(always)]
fn rounded<S: Simd>(simd: S, line: &Line, &[a, b, c]: &Triangle) -> Option<f64> {
    const V: f64 = UNIT_ROUNDOFF;
    let d = line.direction;
    let (edge, other_edge, to_plane) = (way(simd, b, a), way(simd, c, a), way(simd, a, line.origin));
    // The same with other axes in front, for the cross product.
    let [edge_y, other_y] = [way(simd, b.yzx(), a.yzx()), way(simd, c.yzx(), a.yzx())];
    let [edge_z, other_z] = [way(simd, b.zxy(), a.zxy()), way(simd, c.zxy(), a.zxy())];
    let normal = edge_y.times(other_z).minus(edge_z.times(other_y));
    let high_normal = vector_of(normal.high);
    let speed = high_normal.dot(d);
    let nearly = high_normal.dot(vector_of(to_plane.high)) / speed;
    let passed = DoubleDouble::product(f64x4::splat(simd, nearly), lanes_of(simd, d));
    let rest = normal.times(to_plane.minus(passed));
    let (high, low) = (vector_of(rest.high), vector_of(rest.low));
    let [x, y, z] = [(high.x, low.x), (high.y, low.y), (high.z, low.z)];
    let [x, y, z] = [x, y, z].map(|(high, low)| DoubleDouble { high, low });
    let rest = x.plus(y).plus(z);
    let correction = rest.high / speed;

    let size = |lanes: f64x4<S>| vector_of(lanes).abs().max_element();
    let area = size(edge.high) * size(other_edge.high);
    let reach = size(to_plane.high) + nearly.abs() * d.abs().max_element();
    let rest_error = 256.0 * V * V * area * reach + 64.0 * UNDERFLOW * (1.0 + reach + area);
    let speed_error = 64.0 * V * area * d.abs().max_element() + 64.0 * UNDERFLOW;
    let least_speed = speed.abs() - speed_error;
    let error = 2.0 * (rest_error + correction.abs() * speed_error) / least_speed + 8.0 * V * correction.abs();
    // Rounding is monotonic: between two numbers that are rounded to the same `f64`, all others are, too.
    let (lowest, highest) = (nearly + (correction - error), nearly + (correction + error));
    (least_speed > 0.0 && lowest == highest).then_some(lowest)
}

/// The way from one point to another, an axis in each lane.
#[inline(always)]
fn way<S: Simd>(simd: S, to: DVec3, from: DVec3) -> DoubleDouble<f64x4<S>> {
    DoubleDouble::difference(lanes_of(simd, to), lanes_of(simd, from))
}

#[inline(always)]
fn lanes_of<S: Simd>(simd: S, vector: DVec3) -> f64x4<S> {
    f64x4::from_slice(simd, &[vector.x, vector.y, vector.z, 0.0])
}

#[inline(always)]
fn vector_of<S: Simd>(lanes: f64x4<S>) -> DVec3 {
    let mut axes = [0.0; 4];
    lanes.store_slice(&mut axes);
    let [x, y, z, _] = axes;
    DVec3::new(x, y, z)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::tests::{line, point};
    use super::*;

    /// The same at every level.
    fn certain(line: &Line, triangle: &Triangle) -> Option<f64> {
        let [best, baseline] = [Level::new(), Level::baseline()].map(|level| in_double_double(level, line, triangle));
        assert_eq!(best, baseline);
        best
    }

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
            if let Some(t) = certain(&line, &[a, b, c]) {
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
        assert_eq!(certain(&halfway.1, &halfway.0), None);
        assert_eq!(parameter_on_plane(Level::new(), &halfway.1, &halfway.0), 1.0);
        let tiny = wall(1e-320).map(|corner| DVec3::new(1e-200, 1e-200, 1.0) * corner);
        assert_eq!(certain(&ray(0.0), &tiny), None);
        assert_eq!(parameter_on_plane(Level::new(), &ray(0.0), &tiny), 1e-320);
    }
}
