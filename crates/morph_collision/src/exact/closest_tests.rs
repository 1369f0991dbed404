//! Closest points in figures with integer coordinates, where the result is known.

use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::number::power_of_two;
use super::{
    Triangle, closest_of_segment_and_triangle, closest_of_segments, closest_on_segment, closest_on_triangle,
    closest_on_triangle_exactly,
};

const FLOOR: Triangle = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];

/// Integer coordinates with absolute values below `limit`.
fn vector(rng: &mut Pcg64Mcg, limit: i64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| rng.random_range(1 - limit..limit) as f64))
}

fn small(rng: &mut Pcg64Mcg) -> DVec3 {
    vector(rng, 10)
}

/// Coordinates are so large that the rounded closest point often differs from the given one.
#[test]
fn a_point_of_a_triangle_is_its_own_closest_point_at_any_size() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut beside = 0;
    for round in 0..600 {
        let scale = power_of_two([-60, 0, 60][round % 3]);
        let [a, u, v] = std::array::from_fn(|_| vector(&mut rng, 1 << 45));
        let i = rng.random_range(0..8);
        let j = rng.random_range(0..8 - i);
        let point = (a + u * f64::from(i) + v * f64::from(j)) * scale;
        let triangle = [a, a + u * 7.0, a + v * 7.0].map(|corner| corner * scale);
        let closest = closest_on_triangle_exactly(point, &triangle);
        assert_eq!((closest.point, closest.squared), (point, 0.0), "{triangle:?}");
        beside += u32::from(closest_on_triangle(point, &triangle).point != point);
    }
    assert!(beside > 100, "{beside}");
}

#[test]
fn barycentrics_say_where_the_closest_point_is() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for _ in 0..600 {
        let triangle @ [a, b, c] = std::array::from_fn(|_| small(&mut rng));
        let closest = closest_on_triangle(small(&mut rng), &triangle);
        let [x, y, z] = closest.barycentrics;
        assert!(closest.point.abs_diff_eq(a * x + b * y + c * z, 1e-13), "{closest:?}");
    }
}

/// Two segments with a common perpendicular at inner points of both.
#[test]
fn segments_are_closest_where_both_are_upright_to_the_way_between() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut judged = 0;
    while judged < 600 {
        let [foot, d, e] = std::array::from_fn(|_| small(&mut rng));
        let between = d.cross(e);
        if between == DVec3::ZERO {
            continue;
        }
        judged += 1;
        let mut length = || f64::from(rng.random_range(1..5));
        let s = [foot - d * length(), foot + d * length()];
        let t = [foot + between - e * length(), foot + between + e * length()];
        let closest = closest_of_segments(s, t);
        let distance = between.length();
        assert!(
            (closest.squared.sqrt() / distance - 1.0).abs() < 1e-13,
            "{s:?} {t:?} {closest:?}"
        );
        assert!(closest.on_a.abs_diff_eq(foot, 1e-9), "{s:?} {t:?} {closest:?}");
        assert!(
            closest.on_b.abs_diff_eq(foot + between, 1e-9),
            "{s:?} {t:?} {closest:?}"
        );
    }
}

#[test]
fn a_segment_is_closest_to_a_triangle_at_an_end_or_at_an_edge() {
    let cases = [
        ([[1.0, 1.0, 5.0], [1.0, 1.0, 2.0]], [1.0, 1.0, 2.0], [1.0, 1.0, 0.0]),
        ([[2.0, -1.0, -3.0], [2.0, -1.0, 3.0]], [2.0, -1.0, 0.0], [2.0, 0.0, 0.0]),
        ([[1.0, 1.0, 2.0]; 2], [1.0, 1.0, 2.0], [1.0, 1.0, 0.0]),
    ];
    for ([start, end], on_segment, on_floor) in cases {
        for segment in [[start, end], [end, start]] {
            let closest = closest_of_segment_and_triangle(segment.map(DVec3::from), &FLOOR);
            assert_eq!((closest.on_a, closest.on_b), (on_segment.into(), on_floor.into()));
        }
    }
}

/// The square of the point's height underflows.
#[test]
fn a_point_that_is_hardly_above_a_triangle_is_not_on_it() {
    let point = DVec3::new(1.0, 1.0, 1e-200);
    assert!(closest_on_triangle_exactly(point, &FLOOR).squared > 0.0);
}

#[test]
fn beyond_its_ends_a_segment_is_closest_at_an_end_to_the_last_bit() {
    let segment = [DVec3::splat(0.1), DVec3::X * 1e17];
    assert_eq!(closest_on_segment(DVec3::NEG_X, segment), segment[0]);
    assert_eq!(closest_on_segment(DVec3::X * 2e17, segment), segment[1]);
}
