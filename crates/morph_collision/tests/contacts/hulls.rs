//! Convex hulls of points.

use std::sync::Arc;

use glam::{DVec3, Quat, Vec3};
use morph_collision::{ConvexHull, HullError, PlacedShape, Shape};
use morph_collision_testkit::oracle;
use proptest::prelude::*;

/// A hull is right if its faces form a closed surface of corners among the points, and no point is above any of them.
fn check(points: &[Vec3]) -> Result<ConvexHull, HullError> {
    let hull = ConvexHull::new(points)?;
    let corners = hull.points();
    assert!(
        corners
            .iter()
            .all(|corner| points.iter().any(|p| p.as_dvec3() == *corner))
    );
    let mut edges: Vec<(u32, u32)> = Vec::new();
    for &[a, b, c] in hull.faces() {
        edges.extend([(a, b), (b, c), (c, a)]);
        let [a, b, c] = [a, b, c].map(|i| corners[i as usize]);
        for p in points {
            let side = oracle::plane_side(&[a, b, c], p.as_dvec3());
            assert_ne!(side, std::cmp::Ordering::Greater, "{p} is above {a} {b} {c}");
        }
    }
    let all = edges.len();
    edges.sort_unstable();
    edges.dedup();
    assert_eq!(edges.len(), all, "an edge is used twice");
    assert!(edges.iter().all(|(p, q)| edges.binary_search(&(*q, *p)).is_ok()));
    // Euler's formula: it is one surface, like that of a ball.
    assert_eq!(corners.len() + hull.faces().len(), all / 2 + 2);
    Ok(hull)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn hulls_of_points_on_a_grid_are_right(
        points in prop::collection::vec(prop::array::uniform3(-2_i8..3), 0..40),
    ) {
        let points: Vec<Vec3> = points.iter().map(|p| Vec3::from_array(p.map(f32::from))).collect();
        let first = points.first().map(|p| p.as_dvec3());
        let spans_volume = points.iter().any(|b| points.iter().any(|c| points.iter().any(|d| {
            let [a, b, c, d] = [first.unwrap(), b.as_dvec3(), c.as_dvec3(), d.as_dvec3()];
            (b - a).cross(c - a).dot(d - a) != 0.0
        })));
        match check(&points) {
            Ok(_) => prop_assert!(spans_volume),
            Err(HullError::Flat { points: count }) => {
                prop_assert!(!spans_volume);
                prop_assert_eq!(count, points.len());
            }
            Err(error) => prop_assert!(false, "{error}"),
        }
    }

    #[test]
    fn hulls_of_nearly_flat_points_are_right(
        points in prop::collection::vec((-1.0_f32..1.0, -1.0_f32..1.0, 0_u8..3), 4..60),
        tilt in -1.0_f32..1.0,
    ) {
        let points: Vec<Vec3> = points
            .iter()
            .map(|&(x, y, up)| Vec3::new(x, y, tilt * (x + y) + f32::from(up) * f32::EPSILON))
            .collect();
        let result = check(&points);
        prop_assert!(matches!(result, Ok(_) | Err(HullError::Flat { .. })), "{result:?}");
    }
}

#[test]
fn every_point_of_a_ball_is_a_corner_up_to_the_limit() {
    let ball = |count: usize| -> Vec<Vec3> {
        (0..count)
            .map(|i| {
                let y = (i as f64 + 0.5) / count as f64 * 2.0 - 1.0;
                let (around, turn) = ((1.0 - y * y).sqrt(), 2.399_963 * i as f64);
                DVec3::new(around * turn.cos(), y, around * turn.sin()).as_vec3() * 3.0
            })
            .collect()
    };
    assert_eq!(check(&ball(500)).unwrap().points().len(), 500);
    let limit = ConvexHull::MAX_CORNERS;
    assert_eq!(ConvexHull::new(&ball(limit)).unwrap().points().len(), limit);
    let error = ConvexHull::new(&ball(limit + 1)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the convex hull of 4097 points has more than 4096 corners; give it fewer points, such as those of a coarser mesh"
    );
}

#[test]
fn planes_touch_hulls_wherever_the_origin_is() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner + Vec3::new(5.0, -3.0, 100.0));
    let hull = ConvexHull::new(&corners).unwrap();
    for (hull, factor) in [(hull.scaled(Vec3::new(-2.0, 1.0, 1.0)).unwrap(), -2.0), (hull, 1.0)] {
        let placed = PlacedShape::new(Shape::ConvexHull(Arc::new(hull)), Quat::IDENTITY, Vec3::ZERO).unwrap();
        let distance = |x: f64, y: f64, z: f64| {
            placed.signed_distance(DVec3::new(5.0 + x, y - 3.0, 100.0 + z) * DVec3::new(factor, 1.0, 1.0))
        };
        assert!((distance(0.125, 0.125, 0.0625) + 0.0625).abs() < 1e-13);
        assert!((distance(0.25, 0.25, -0.5) - 0.5).abs() < 1e-13);
    }
}

#[test]
fn almost_collinear_points_have_a_hull() {
    // Cross products of the first four underflow or are rounding error.
    let tiny = f32::from_bits(1);
    let points = [
        Vec3::ZERO,
        Vec3::X,
        Vec3::X,
        Vec3::ZERO,
        Vec3::new(0.5, tiny, 0.0),
        Vec3::new(0.5, 0.0, tiny),
    ];
    assert_eq!(check(&points).unwrap().points().len(), 4);
    assert!(ConvexHull::new(&points[..5]).is_err());
}

#[test]
fn corners_of_a_grid_are_the_only_points_of_its_hull() {
    let grid = |i: u32| Vec3::new((i % 5) as f32, (i / 5 % 5) as f32, (i / 25) as f32);
    let points: Vec<Vec3> = (0..125).map(grid).collect();
    assert_eq!(check(&points).unwrap().points().len(), 8);
}

#[test]
fn bad_points_are_refused_by_number() {
    let mut corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE];
    corners[3].y = f32::NAN;
    let error = ConvexHull::new(&corners).unwrap_err();
    assert!(error.to_string().starts_with("point 3: coordinate 1 is NaN"), "{error}");
    let flat = ConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE - Vec3::Z]).unwrap_err();
    assert!(flat.to_string().contains("of 4 points has no volume"), "{flat}");
    assert!(ConvexHull::new(&[]).is_err());
}

#[test]
fn a_scaled_hull_is_the_hull_of_scaled_points() {
    let points: Vec<Vec3> = (0..60)
        .map(|i| Vec3::new((i as f32).sin(), (1.7 * i as f32).cos(), (2.3 * i as f32).sin()))
        .collect();
    let hull = ConvexHull::new(&points).unwrap();
    for scale in [Vec3::new(2.0, 0.5, 4.0), Vec3::new(-1.0, 8.0, 0.25), Vec3::splat(-2.0)] {
        let scaled = hull.scaled(scale).unwrap();
        let of_scaled: Vec<Vec3> = points.iter().map(|point| point * scale).collect();
        let of_scaled = check(&of_scaled).unwrap();
        assert_eq!(scaled.points(), of_scaled.points());
        let sorted = |hull: &ConvexHull| {
            let turned = hull.faces().iter().map(|&[a, b, c]| match a.min(b).min(c) {
                first if first == a => [a, b, c],
                first if first == b => [b, c, a],
                _ => [c, a, b],
            });
            let mut faces: Vec<_> = turned.collect();
            faces.sort_unstable();
            faces
        };
        assert_eq!(sorted(&scaled), sorted(&of_scaled), "{scale}");
    }
    for scale in [Vec3::new(1.0, 0.0, 1.0), Vec3::NAN, Vec3::splat(f32::INFINITY)] {
        assert!(hull.scaled(scale).is_err());
    }
    for scale in [1e18, 1e-45] {
        let mut scaled = hull.clone();
        let mut times = 0;
        while let Ok(next) = scaled.scaled(Vec3::splat(scale)) {
            scaled = next;
            times += 1;
        }
        assert_eq!(times, 2, "{scale}");
    }
}
