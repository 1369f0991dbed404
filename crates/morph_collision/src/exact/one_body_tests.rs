//! Tests of rays, regions and closest points against other arithmetic.

use fearless_simd::Level;
use glam::DVec3;
use morph_collision_testkit::oracle::{self, Dyadic};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{
    Line, Plane, Triangle, closest_of_triangles, closest_on_triangle, ray_meets_triangle, triangle_meets_region,
};

/// Points of a coarse grid, so that rays in a triangle's plane, through its corners and along its edges are common.
fn grid_point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-2_i8..3).prop_map(|c| DVec3::from_array(c.map(f64::from)))
}

fn grid_triangle() -> impl Strategy<Value = Triangle> {
    prop::array::uniform3(grid_point())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn a_ray_meets_what_its_segment_meets_and_not_before(
        origin in grid_point(), direction in grid_point(), max_t in 0_u8..4, triangle in grid_triangle(),
    ) {
        prop_assume!(direction != DVec3::ZERO);
        let max_t = f64::from(max_t) * 0.5;
        let meets = |t: f64| {
            let end = origin + direction * t;
            oracle::triangles_intersect(&[origin, end, end], &triangle)
        };
        match ray_meets_triangle(Level::new(), &Line { origin, direction, max_t }, &triangle) {
            Some(crossing) => {
                prop_assert!(meets(max_t));
                prop_assert!(closest_on_triangle(origin + direction * crossing.t, &triangle).squared < 1e-24);
                prop_assert!(crossing.t == 0.0 || !meets(crossing.t * (1.0 - 1e-9)));
            }
            None => prop_assert!(!meets(max_t)),
        }
        let unlimited = ray_meets_triangle(Level::new(), &Line { origin, direction, max_t: f64::INFINITY }, &triangle);
        prop_assert_eq!(unlimited.is_some(), meets(64.0));
    }

    #[test]
    fn a_triangle_meets_a_box_exactly_if_the_oracle_says_so(a in grid_point(), b in grid_point(), triangle in grid_triangle()) {
        let (min, max) = (a.min(b), a.max(b));
        let planes: Vec<Plane> = (0..3)
            .flat_map(|axis| {
                let normal = DVec3::AXES[axis];
                [
                    Plane { normal, offset: -min[axis] },
                    Plane { normal: -normal, offset: max[axis] },
                ]
            })
            .collect();
        let corner = |i: usize| DVec3::new(
            if i & 1 == 1 { max.x } else { min.x },
            if i & 2 == 2 { max.y } else { min.y },
            if i & 4 == 4 { max.z } else { min.z },
        );
        let faces = [[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 3, 6], [3, 7, 6], [0, 2, 4], [2, 6, 4], [1, 3, 5], [3, 7, 5]];
        let inside = triangle.iter().any(|p| min.cmple(*p).all() && p.cmple(max).all());
        let truth = inside || faces.iter().any(|face| oracle::triangles_intersect(&face.map(corner), &triangle));
        prop_assert_eq!(triangle_meets_region(&triangle, &planes), truth);
    }

    #[test]
    fn closest_points_of_two_triangles_lie_on_both(a in grid_triangle(), b in grid_triangle()) {
        let closest = closest_of_triangles(&a, &b);
        prop_assert_eq!(closest.squared == 0.0, oracle::triangles_intersect(&a, &b));
        prop_assert!((closest.on_a.distance(closest.on_b) - closest.squared.sqrt()).abs() < 1e-12);
        prop_assert!(closest_on_triangle(closest.on_a, &a).squared < 1e-24);
        prop_assert!(closest_on_triangle(closest.on_b, &b).squared < 1e-24);
    }
}

#[test]
fn the_inside_of_a_sliver_is_found() {
    // The edges are 40 times as far away as the interior.
    for width in [1e-3, 1e-6, 1e-9, 1e-12] {
        let sliver = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, width, 0.0)];
        let height = 0.01 * width;
        let closest = closest_on_triangle(DVec3::new(0.5, 0.4 * width, height), &sliver);
        assert!((closest.squared.sqrt() - height).abs() < 4e-16, "{width}: {closest:?}");
    }
}

#[test]
fn the_inside_of_nearly_parallel_edges_is_found() {
    for slope in [1e-3, 1e-6, 1e-9] {
        let height = 0.01 * slope;
        let flat = |a: DVec3, b: DVec3| [a, b, b];
        let first = flat(DVec3::new(-1.0, -slope, 0.0), DVec3::new(1.0, slope, 0.0));
        let second = flat(DVec3::new(-1.0, slope, height), DVec3::new(1.0, -slope, height));
        let closest = closest_of_triangles(&first, &second);
        assert!(
            (closest.squared.sqrt() / height - 1.0).abs() < 1e-12,
            "{slope}: {closest:?}"
        );
    }
}

/// Points a few roundings in front of a plane or behind it, compared with the exact sum of products.
#[test]
fn points_within_roundings_of_a_plane_are_classified_exactly() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut decided = [0, 0];
    for _ in 0..20_000 {
        let size = [1.0, 1e6][rng.random_range(0..2)];
        let mut vector = || DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let (normal, point) = (vector(), vector() * size);
        let mut offset = -normal.dot(point);
        for _ in 0..rng.random_range(0..4) {
            offset = if rng.random_bool(0.5) {
                offset.next_up()
            } else {
                offset.next_down()
            };
        }
        let terms = (0..3).map(|i| Dyadic::from(normal[i]) * Dyadic::from(point[i]));
        let depth = terms.sum::<Dyadic>() + Dyadic::from(offset);
        let inside = triangle_meets_region(&[point; 3], &[Plane { normal, offset }]);
        assert_eq!(inside, !depth.is_negative(), "{normal} {offset} {point}");
        decided[usize::from(inside)] += 1;
    }
    assert!(decided.iter().all(|count| *count > 5000), "{decided:?}");
}

/// The distance of a point on a tilted sliver is 0 up to roundings; rounded normals would give a much larger one.
#[test]
fn points_on_tilted_slivers_have_distance_zero() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for round in 0..600 {
        let width = [1e-3, 1e-6, 1e-9][round % 3];
        let mut vector = || DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let (a, along, aside) = (vector(), vector(), vector());
        let (b, c) = (a + along, a + along * 0.5 + aside * width);
        let point = a + (b - a) * 0.3 + (c - a) * 0.4;
        let closest = closest_on_triangle(point, &[a, b, c]);
        let distance = closest.squared.sqrt();
        assert!(distance < 1e-15, "{distance} at width {width}");
        assert!(closest.point.distance(point) < 2e-15, "{closest:?} at width {width}");
    }
}

/// Every corner is outside, and no plane has all of them on its far side.
#[test]
fn a_triangle_with_all_corners_outside_a_wedge_may_miss_its_edge_or_hold_it() {
    let wedge = [DVec3::X, DVec3::Y].map(|normal| Plane { normal, offset: 0.0 });
    let [left, right] = [DVec3::new(-2.0, 1.0, 0.0), DVec3::new(1.0, -2.0, 0.0)];
    for tip in [-0.1, -0.5, -2.0] {
        let triangle = [DVec3::new(tip, tip, 0.0), right, left];
        assert!(!triangle_meets_region(&triangle, &wedge), "{tip}");
    }
    let [left, right] = [DVec3::new(-1.0, 2.0, 0.0), DVec3::new(2.0, -1.0, 0.0)];
    assert!(triangle_meets_region(
        &[DVec3::new(-1.0, -1.0, 0.0), right, left],
        &wedge
    ));
}

/// Along both directions, so that quotients have speeds of both signs.
#[test]
fn a_ray_along_a_triangle_without_area_meets_it_from_its_nearer_end_on() {
    let segment = [DVec3::X, DVec3::X * 3.0, DVec3::X * 2.0];
    for (origin, direction, max_t, expected) in [
        (0.0, 1.0, 5.0, Some(1.0)),
        (1.0, 1.0, 5.0, Some(0.0)),
        (2.5, 1.0, 5.0, Some(0.0)),
        (3.0, 1.0, 5.0, Some(0.0)),
        (3.5, 1.0, 5.0, None),
        (4.0, -1.0, f64::INFINITY, Some(1.0)),
        (3.0, -1.0, f64::INFINITY, Some(0.0)),
        (2.5, -1.0, f64::INFINITY, Some(0.0)),
        (1.0, -1.0, f64::INFINITY, Some(0.0)),
        (0.5, -1.0, f64::INFINITY, None),
        (5.0, -1.0, 2.0, Some(2.0)),
        (5.0, -1.0, 1.5, None),
    ] {
        let line = Line {
            origin: DVec3::X * origin,
            direction: DVec3::X * direction,
            max_t,
        };
        let t = ray_meets_triangle(Level::new(), &line, &segment).map(|crossing| crossing.t.to_bits());
        assert_eq!(t, expected.map(f64::to_bits), "from {origin} by {direction}");
    }
    let beside = Line {
        origin: DVec3::Y,
        direction: DVec3::X,
        max_t: f64::INFINITY,
    };
    assert!(ray_meets_triangle(Level::new(), &beside, &segment).is_none());
}
