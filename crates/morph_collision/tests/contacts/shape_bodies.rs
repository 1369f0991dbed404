//! Queries for shapes and bodies give the same answers as tests of every triangle.

use std::ops::ControlFlow;

use glam::{Affine3A, DVec3, Quat, Vec3};
use morph_collision::{BuildOptions, PlacedShape, Shape, ShapeContact, ShapeQuery};
use morph_collision_models::generated::random;
use morph_collision_testkit::oracle;

use crate::bodies::{Placed, assorted, at};
use crate::signed_distance::{Twin, around};

fn middle(placed: &Placed) -> (Vec3, f32) {
    let (low, high) = placed
        .triangles
        .iter()
        .flatten()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
            (low.min(*p), high.max(*p))
        });
    let radius = (0.5 * (high - low).max_element()).max(1e-3);
    ((0.5 * (low + high)).as_vec3(), radius as f32)
}

fn triangles_of(query: &mut ShapeQuery, placed: &mut Placed, shape: &PlacedShape) -> Vec<u32> {
    let mut found = Vec::new();
    query.all(placed.body(), shape, &mut found);
    found.sort_unstable();
    found
}

fn one_by_one(placed: &Placed, shape: &PlacedShape) -> Vec<u32> {
    (0..placed.triangles.len() as u32)
        .filter(|&t| shape.intersects(&placed.triangles[t as usize]))
        .collect()
}

/// Every contact of a body with a shape, sorted by triangle.
fn all_contacts(query: &mut ShapeQuery, placed: &mut Placed, shape: &PlacedShape, within: f64) -> Vec<ShapeContact> {
    let mut contacts = Vec::new();
    query.contacts(placed.body(), shape, within, &mut contacts).unwrap();
    contacts.sort_by_key(|contact| contact.triangle);
    contacts
}

#[test]
fn intersecting_triangles_are_those_found_one_by_one() {
    let mut query = ShapeQuery::new();
    let (mut hits, mut misses) = (0, 0);
    for mut placed in assorted() {
        let (center, radius) = middle(&placed);
        for twin in around(center, radius) {
            let expected = one_by_one(&placed, &twin.placed);
            let found = triangles_of(&mut query, &mut placed, &twin.placed);
            assert_eq!(found, expected, "{} and {:?}", placed.name, twin.shape);
            assert_eq!(query.any(placed.body(), &twin.placed), !expected.is_empty());
            hits += expected.len();
            misses += placed.triangles.len() - expected.len();
        }
    }
    assert!(hits > 10_000 && misses > 10_000, "{hits} hits, {misses} misses");
}

#[test]
fn signed_distances_agree_with_a_search_and_contacts_hold_together() {
    let mut query = ShapeQuery::new();
    for mut placed in assorted() {
        let (center, radius) = middle(&placed);
        for twin in around(center, radius) {
            let name = format!("{} and {:?}", placed.name, twin.shape);
            let contacts = all_contacts(&mut query, &mut placed, &twin.placed, f64::INFINITY);
            assert_eq!(contacts.len(), placed.triangles.len(), "{name}");
            let tolerance = 1e-11 * (placed.reach() + 20.0 * f64::from(radius));
            let is_known_by_support = matches!(
                twin.shape,
                Shape::Cylinder { .. } | Shape::Cone { .. } | Shape::ConicalFrustum { .. } | Shape::ConvexHull(_)
            );
            for contact in &contacts {
                let may_not_see_a_gap = is_known_by_support && contact.distance == 0.0;
                let blind = if may_not_see_a_gap {
                    1.5e3 * tolerance
                } else {
                    tolerance
                };
                let triangle = &placed.triangles[contact.triangle as usize];
                assert_eq!(
                    contact.distance <= 0.0,
                    twin.placed.intersects(triangle),
                    "{name}: {contact:?}"
                );
                let at_point = twin.of_point(contact.point_on_triangle);
                assert!(
                    (at_point - contact.distance).abs() < blind,
                    "{name}: {contact:?}, {at_point}"
                );
                let off = on_triangle(contact.point_on_triangle, triangle);
                assert!(off < tolerance, "{name}: {contact:?} is {off} off");
                let apart = contact.point_on_triangle - contact.point_on_shape - contact.normal * contact.distance;
                assert!(apart.length() < tolerance, "{name}: {contact:?}");
                let unit = contact.normal.length();
                assert!((unit - 1.0).abs() < 1e-12 || unit == 0.0, "{name}: {contact:?}");
            }
            // Check some of them with an independent search, which is slow.
            let step = match twin.shape {
                Shape::Ball { .. } | Shape::Capsule { .. } | Shape::Cuboid { .. } | Shape::HalfSpace { .. } => 7,
                _ => 150,
            };
            for contact in contacts.iter().step_by(step) {
                let searched = twin.of_triangle(&placed.triangles[contact.triangle as usize]);
                assert!(
                    (searched - contact.distance).abs() < 1e3 * tolerance,
                    "{name}: {contact:?}, {searched}"
                );
            }
            let closest = query.closest(placed.body(), &twin.placed, f64::INFINITY).unwrap();
            // Not `total_cmp`, in which -0 comes before 0.
            let best = contacts
                .iter()
                .min_by(|s, t| s.distance.partial_cmp(&t.distance).unwrap());
            assert_eq!(closest.as_ref(), best, "{name}");
        }
    }
}

/// The distance of a point from a triangle, computed independently.
fn on_triangle(point: DVec3, triangle: &[DVec3; 3]) -> f64 {
    crate::triangles::distance(point, triangle)
}

#[test]
fn contacts_within_a_distance_are_those_of_all_that_are() {
    let mut query = ShapeQuery::new();
    for mut placed in assorted().into_iter().step_by(3) {
        let (center, radius) = middle(&placed);
        for twin in around(center, radius) {
            let all = all_contacts(&mut query, &mut placed, &twin.placed, f64::INFINITY);
            for within in [-0.1 * f64::from(radius), 0.0, 0.3 * f64::from(radius)] {
                let expected: Vec<_> = all.iter().filter(|c| c.distance <= within).copied().collect();
                let found = all_contacts(&mut query, &mut placed, &twin.placed, within);
                assert_eq!(found, expected, "{} within {within} of {:?}", placed.name, twin.shape);
                let closest = query.closest(placed.body(), &twin.placed, within).unwrap();
                assert_eq!(closest.is_some(), !expected.is_empty());
            }
        }
    }
}

#[test]
fn balls_that_just_touch_or_just_do_not_are_told_apart() {
    let mut query = ShapeQuery::new();
    let mut touching = [0, 0];
    for mut placed in assorted() {
        let (center, radius) = middle(&placed);
        for offset in [
            Vec3::new(2.0, 0.4, 0.1),
            Vec3::new(-0.3, 0.2, 1.7),
            Vec3::new(0.05, 0.1, -0.1),
        ] {
            let place = center + offset * radius;
            let ball = |radius| PlacedShape::new(Shape::Ball { radius }, Quat::IDENTITY, place).unwrap();
            let closest = query.closest(placed.body(), &ball(0.0), f64::INFINITY).unwrap();
            let nearest = closest.unwrap().distance.max(0.0) as f32;
            for radius in [nearest.next_down().max(0.0), nearest, nearest.next_up()] {
                let ball = ball(radius);
                let expected = one_by_one(&placed, &ball);
                touching[usize::from(expected.is_empty())] += 1;
                assert_eq!(
                    triangles_of(&mut query, &mut placed, &ball),
                    expected,
                    "{}",
                    placed.name
                );
            }
        }
    }
    assert!(touching[0] > 50 && touching[1] > 50, "{touching:?}");
}

#[test]
fn half_spaces_touched_by_one_corner_are_told_apart() {
    let mut query = ShapeQuery::new();
    for mut placed in assorted() {
        let lowest = placed
            .triangles
            .iter()
            .flatten()
            .map(|p| p.y)
            .fold(f64::INFINITY, f64::min);
        for height in [(lowest as f32).next_down(), lowest as f32, (lowest as f32).next_up()] {
            let place = Vec3::Y * height;
            let floor = PlacedShape::new(Shape::HalfSpace { normal: Vec3::Y }, Quat::IDENTITY, place).unwrap();
            let truth: Vec<u32> = (0..placed.triangles.len() as u32)
                .filter(|&t| placed.triangles[t as usize].iter().any(|p| p.y <= f64::from(height)))
                .collect();
            assert_eq!(triangles_of(&mut query, &mut placed, &floor), truth, "{}", placed.name);
        }
    }
}

#[test]
fn capsules_without_radius_agree_with_the_oracle_on_bodies() {
    let mut query = ShapeQuery::new();
    for mut placed in assorted() {
        // The segment passes through a corner of the mesh, so that it only touches some triangles.
        let middle = placed.triangles[0][0].as_vec3();
        let half_length = (middle - placed.triangles[placed.triangles.len() / 2][1].as_vec3()).length();
        let shape = Shape::Capsule {
            half_length,
            radius: 0.0,
        };
        let segment = PlacedShape::new(shape, Quat::IDENTITY, middle).unwrap();
        let (middle, half) = (middle.as_dvec3(), DVec3::Y * f64::from(half_length));
        let (p, q) = (middle - half, middle + half);
        let truth: Vec<u32> = (0..placed.triangles.len() as u32)
            .filter(|&t| oracle::triangles_intersect(&placed.triangles[t as usize], &[p, q, q]))
            .collect();
        assert_eq!(
            triangles_of(&mut query, &mut placed, &segment),
            truth,
            "{}",
            placed.name
        );
    }
}

#[test]
fn tiny_huge_and_far_off_bodies_are_answered_like_any_other() {
    let mesh = random::random_blob(7, 2, 2, 0.5);
    let mut query = ShapeQuery::new();
    for (scale, offset) in [
        (1e-25, 0.0),
        (1e-12, 0.0),
        (1e12, 0.0),
        (1e25, 0.0),
        (1.0, 1e6),
        (1e-3, 3e7),
    ] {
        let place = Affine3A::from_scale_rotation_translation(
            Vec3::splat(scale),
            Quat::from_rotation_y(0.3),
            Vec3::new(offset, -offset, offset),
        );
        let mut placed = Placed::new("blob", &mesh, &[0.4, -0.3], place, &BuildOptions::default());
        let near = Vec3::new(offset + 0.3 * scale, -offset, offset + 0.6 * scale);
        let mut hits = 0;
        for twin in around(near, scale) {
            let expected = one_by_one(&placed, &twin.placed);
            let found = triangles_of(&mut query, &mut placed, &twin.placed);
            assert_eq!(found, expected, "{scale} at {offset}: {:?}", twin.shape);
            hits += expected.len();
        }
        assert!(hits > 100, "{scale} at {offset}: {hits}");
    }
}

#[test]
fn a_ball_inside_a_closed_surface_touches_nothing() {
    let mesh = random::random_blob(3, 3, 2, 0.5);
    let mut placed = Placed::new("blob", &mesh, &[0.1, 0.1], at(0.0, 0.0, 0.0), &BuildOptions::default());
    let twin = Twin::new(Shape::Ball { radius: 0.05 }, Quat::IDENTITY, Vec3::ZERO);
    let mut query = ShapeQuery::new();
    assert!(!query.any(placed.body(), &twin.placed));
    let closest = query.closest(placed.body(), &twin.placed, 10.0).unwrap();
    assert!(closest.unwrap().distance > 0.2);
}

#[test]
fn few_nodes_are_looked_at() {
    let mesh = random::random_blob(3, 5, 2, 0.5);
    let mut placed = Placed::new("blob", &mesh, &[0.1, 0.1], at(0.0, 0.0, 0.0), &BuildOptions::default());
    let nodes = placed.pose.bvh().node_count() as u64;
    let mut query = ShapeQuery::new();
    for shape in [Shape::Ball { radius: 0.5 }, Shape::HalfSpace { normal: Vec3::NEG_X }] {
        let far = Twin::new(shape.clone(), Quat::IDENTITY, Vec3::X * 5.0);
        assert!(!query.any(placed.body(), &far.placed));
        let stats = query.stats();
        assert_eq!((stats.node_tests, stats.triangle_tests), (1, 0), "{shape:?}");
    }
    let surface = query
        .closest(
            placed.body(),
            &Twin::new(Shape::Ball { radius: 0.0 }, Quat::IDENTITY, Vec3::X * 5.0).placed,
            f64::INFINITY,
        )
        .unwrap();
    let near = surface.unwrap().point_on_triangle.as_vec3();
    for shape in [
        Shape::Ball { radius: 0.02 },
        Shape::Capsule {
            half_length: 0.05,
            radius: 0.01,
        },
        Shape::Cuboid {
            half_extents: Vec3::splat(0.02),
        },
        Shape::Capsule {
            half_length: 0.1,
            radius: 0.0,
        },
    ] {
        placed.pose.set_weights(&[0.0, 0.0]).unwrap();
        placed.pose.set_weights(&[0.1, 0.1]).unwrap();
        let twin = Twin::new(shape.clone(), Quat::from_rotation_z(0.3), near);
        let mut found = 0;
        query.visit(placed.body(), &twin.placed, |_| {
            found += 1;
            ControlFlow::Continue(())
        });
        let stats = query.stats();
        assert!(found > 0, "{shape:?}");
        assert!(stats.nodes_blended * 20 < nodes, "{shape:?}: {stats:?} of {nodes}");
        placed.pose.set_weights(&[0.0, 0.0]).unwrap();
        placed.pose.set_weights(&[0.1, 0.1]).unwrap();
        query.closest(placed.body(), &twin.placed, f64::INFINITY).unwrap();
        let stats = query.stats();
        assert!(
            stats.nodes_blended * 20 < nodes,
            "{shape:?}, closest: {stats:?} of {nodes}"
        );
    }
}
