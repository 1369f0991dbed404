//! Closest points on the surface, checked against every triangle.

use glam::DVec3;
use morph_collision::{Body, ClosestPoint, PlacedShape, ShapeQuery};

use crate::bodies::{self, Case, Random, box_around};
use crate::reference::{Corners, at, point_triangle};

/// Points around the body, far away, and on its surface.
fn points(triangles: &[Corners], count: usize) -> Vec<DVec3> {
    let mut random = Random(17);
    let bounds = box_around(triangles);
    (0..count)
        .map(|i| {
            let triangle = &triangles[random.below(triangles.len())];
            match i % 6 {
                0 => triangle[random.below(3)],
                1 => at([0.5, 0.25, 0.25], triangle),
                2 => at([0.5, 0.25, 0.25], triangle) + random.point() * 1e-6,
                3 => random.point() * 1e5,
                _ => random.around(bounds),
            }
        })
        .collect()
}

fn agrees(case: &Case, count: usize) {
    let triangles = case.world_triangles();
    let world_from_model = case.world_from_model();
    let (min, max) = box_around(&triangles);
    let mut poses = case.poses();
    let mut query = ShapeQuery::new();
    for point in points(&triangles, count) {
        let distances: Vec<f64> = triangles.iter().map(|t| point_triangle(point, t)).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        // The reference itself has errors this large on slivers.
        let share = if case.name == "slivers" { 1e-9 } else { 1e-11 };
        let slack = share * (least + (max - min).length());
        let mut first: Option<ClosestPoint> = None;
        for pose in &mut poses {
            let closest = query.closest_point(Body::new(pose, &world_from_model), point, f64::INFINITY);
            let closest = closest.unwrap().unwrap();
            assert!(
                (closest.distance - least).abs() <= slack,
                "{}: {closest:?} from {point}, not {least}",
                case.name
            );
            let triangle = &triangles[closest.triangle as usize];
            assert!((at(closest.barycentrics, triangle) - closest.point).length() <= slack);
            assert!((closest.point.distance(point) - closest.distance).abs() <= slack + 1e-15 * point.length());
            assert!(closest.barycentrics.iter().all(|share| *share >= 0.0));
            assert_eq!(*first.get_or_insert(closest), closest, "{}: another tree", case.name);

            // A ball that just contains the closest point finds it; a slightly smaller one finds nothing.
            let mut within = |radius: f64| {
                let ball = PlacedShape::ball(point, radius).unwrap();
                let found = query
                    .closest_point(Body::new(pose, &world_from_model), point, radius)
                    .unwrap();
                let meets = ShapeQuery::new().any(Body::new(pose, &world_from_model), &ball);
                assert_eq!(found.is_some(), meets, "{}", case.name);
                found
            };
            assert_eq!(within(closest.distance), Some(closest));
            if closest.distance > 0.0 {
                assert_eq!(within(closest.distance * (1.0 - 1e-12)), None);
            }

            let radius = least + 0.2 * (max - min).length();
            let mut inside = Vec::new();
            let ball = PlacedShape::ball(point, radius).unwrap();
            ShapeQuery::new().all(Body::new(pose, &world_from_model), &ball, &mut inside);
            inside.sort_unstable();
            for (number, distance) in distances.iter().enumerate() {
                if (distance - radius).abs() > slack {
                    let found = inside.binary_search(&(number as u32)).is_ok();
                    assert_eq!(found, *distance < radius, "{}: triangle {number}", case.name);
                }
            }
        }
    }
}

#[test]
fn projections_agree_with_brute_force_on_generated_bodies() {
    for case in bodies::generated() {
        agrees(&case, 30);
    }
}

#[test]
fn projections_agree_with_brute_force_on_real_models() {
    for case in bodies::real() {
        agrees(&case, 12);
    }
}
