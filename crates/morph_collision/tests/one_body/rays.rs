//! Rays, checked against every triangle by the exact oracle. A ray is passed to it as a triangle with two equal corners.

use glam::DVec3;
use morph_collision::{Body, Facing, Rank, Ray, RayHit, RayQuery};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle;

use crate::bodies::{self, Case, Random, box_around, snap};
use crate::reference::{Corners, at, point_triangle, touch};

/// A ray from `origin` to `origin + 2 direction`, which is computed exactly for coordinates up to 2^11.
#[derive(Clone, Copy, Debug)]
struct Shot {
    origin: DVec3,
    direction: DVec3,
}

const MAX_T: f64 = 2.0;

impl Shot {
    fn towards(origin: DVec3, target: DVec3) -> Self {
        let origin = snap(origin, 0.5_f64.powi(10));
        let direction = snap(target - origin, 0.5_f64.powi(40));
        Self { origin, direction }
    }

    /// Whether the first part of the ray, a given share of its length, meets a triangle.
    fn meets(&self, triangle: &Corners, share: f64) -> bool {
        let end = self.origin + self.direction * (MAX_T * share);
        touch(&[self.origin, end, end], triangle)
    }
}

/// Rays at corners, at edges, into triangles, and past the body. Some start on the surface.
fn shots(triangles: &[Corners], count: usize, seed: u64) -> Vec<Shot> {
    let mut random = Random(seed);
    let bounds = box_around(triangles);
    let mut shots = Vec::new();
    for kind in 0..count {
        let triangle = triangles[random.below(triangles.len())];
        let target = match kind % 5 {
            0 => triangle[random.below(3)],
            1 => 0.5 * (triangle[0] + triangle[1]),
            2 => at([0.25, 0.5, 0.25], &triangle),
            3 => random.around(bounds),
            // In the direction of an edge, so in the triangle's plane.
            _ => triangle[1] * 2.0 - triangle[0],
        };
        let origin = match kind % 7 {
            0 => snap(triangle[0], 0.5_f64.powi(10)),
            _ => random.around(bounds),
        };
        let origin = if kind % 5 == 4 { triangle[0] } else { origin };
        let shot = Shot::towards(origin, target);
        if shot.direction != DVec3::ZERO {
            shots.push(shot);
        }
    }
    shots
}

/// Checks a single hit: it is on the ray and on the triangle, where the ray first meets the triangle.
fn check_hit(hit: &RayHit, shot: &Shot, triangle: &Corners, name: &str) {
    let first = oracle::ray_parameter(shot.origin, shot.direction, triangle);
    assert_eq!(Some(hit.t), first, "{name}: {hit:?}");
    let size = (triangle[0] - shot.origin)
        .length()
        .max((triangle[1] - triangle[0]).length())
        .max((triangle[2] - triangle[0]).length());
    let on_ray = shot.origin + shot.direction * hit.t;
    assert!(
        (hit.point - on_ray).length() <= 1e-9 * size,
        "{name}: {hit:?} is off {shot:?}"
    );
    assert!((at(hit.barycentrics, triangle) - hit.point).length() <= 1e-12 * size.max(hit.point.length()));
    assert!(hit.barycentrics.iter().all(|share| *share >= 0.0));
    assert!((hit.barycentrics.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert!((hit.distance - hit.t * shot.direction.length()).abs() <= 1e-12 * hit.distance);
    let [a, b, c] = *triangle;
    let along = (b - a).cross(c - a).dot(shot.direction);
    let certain = 1e-12 * (b - a).length() * (c - a).length() * shot.direction.length();
    if along.abs() > certain {
        let facing = if along < 0.0 { Facing::Front } else { Facing::Back };
        assert_eq!(hit.facing, facing, "{name}: {hit:?}");
    }
    if hit.facing != Facing::EdgeOn && (b - a).cross(c - a).length() > 1e-6 * (b - a).length() * (c - a).length() {
        assert!((hit.normal.length() - 1.0).abs() < 1e-12);
        assert!(hit.normal.dot(b - a).abs() <= 1e-9 * (b - a).length());
    }
}

fn agrees(case: &Case, count: usize) -> usize {
    let triangles = case.world_triangles();
    let world_from_model = case.world_from_model();
    let mut poses = case.poses();
    let mut query = RayQuery::new();
    let mut found = 0;
    for shot in shots(&triangles, count, 5) {
        let ray = Ray::new(shot.origin, shot.direction, MAX_T).unwrap();
        let truth: Vec<u32> = (0..triangles.len() as u32)
            .filter(|&t| shot.meets(&triangles[t as usize], 1.0))
            .collect();
        found += truth.len();
        let mut first: Option<Vec<RayHit>> = None;
        for pose in &mut poses {
            let mut hits = Vec::new();
            query.all(Body::new(pose, &world_from_model), &ray, &mut hits);
            let mut numbers: Vec<u32> = hits.iter().map(|hit| hit.triangle).collect();
            assert!(hits.is_sorted_by(|a, b| (a.t, a.triangle) < (b.t, b.triangle)));
            numbers.sort_unstable();
            assert_eq!(numbers, truth, "{}: {shot:?}", case.name);
            let any = query.any(Body::new(pose, &world_from_model), &ray);
            assert_eq!(any, !truth.is_empty());
            let closest = query.closest(Body::new(pose, &world_from_model), &ray);
            assert_eq!(closest, hits.first().copied(), "{}: {shot:?}", case.name);
            // Equal bit for bit in all trees.
            assert_eq!(first.get_or_insert_with(|| hits.clone()), &hits, "{}", case.name);
        }
        for hit in first.iter().flatten() {
            check_hit(hit, &shot, &triangles[hit.triangle as usize], &case.name);
        }
    }
    found
}

#[test]
fn hits_agree_with_the_oracle_on_generated_bodies() {
    let mut found = 0;
    for case in bodies::generated() {
        let here = agrees(&case, 40);
        // Rays whose coordinates have few digits cannot hit a line whose points have none with so few.
        let can_hit = case.name != "blob a slanted line";
        assert!(here > 10 || !can_hit, "{}: {here} hits try nothing", case.name);
        found += here;
    }
    assert!(found > 2000, "{found} hits");
}

#[test]
fn hits_agree_with_the_oracle_on_real_models() {
    for case in bodies::real() {
        assert!(agrees(&case, 15) > 5, "{}", case.name);
    }
}

/// A closed surface has no holes: from inside, a ray aimed at any corner or edge hits a triangle.
#[test]
fn no_ray_leaves_a_closed_surface_unseen() {
    let blob = morph_collision_models::generated::random::random_blob(3, 2, 2, 0.0);
    for (name, world_from_model) in bodies::odd_places().into_iter().take(4) {
        let case = Case::new(name, blob.clone(), vec![0.05, -0.05], world_from_model);
        let triangles = case.world_triangles();
        let center = case.world_from_model().transform_point(glam::Vec3::ZERO);
        let mut pose = case.poses().swap_remove(0);
        let world_from_model = case.world_from_model();
        for [a, b, c] in triangles {
            for target in [a, 0.5 * (a + b), a + (b - a) * 0.3, (a + b + c) / 3.0] {
                let ray = Ray::new(center, target - center, f64::INFINITY).unwrap();
                let hit = RayQuery::new().closest(Body::new(&mut pose, &world_from_model), &ray);
                assert!(hit.is_some(), "{name}: towards {target}");
            }
        }
    }
}

#[test]
fn the_predicate_sees_through_what_it_rejects() {
    let case = &bodies::generated()[1];
    let triangles = case.world_triangles();
    let world_from_model = case.world_from_model();
    let mut rejected = 0;
    for pose in &mut case.poses() {
        for shot in shots(&triangles, 30, 9) {
            let ray = Ray::new(shot.origin, shot.direction, f64::INFINITY).unwrap();
            let mut hits = Vec::new();
            RayQuery::new().all(Body::new(pose, &world_from_model), &ray, &mut hits);
            let back = |hit: &RayHit| hit.facing == Facing::Back;
            let expected = hits.iter().copied().find(back);
            rejected += usize::from(expected != hits.first().copied());
            let closest = RayQuery::new().closest_where(Body::new(pose, &world_from_model), &ray, back);
            assert_eq!(closest, expected);
        }
    }
    assert!(rejected > 10);
}

#[test]
fn any_hit_stops_at_the_first() {
    let case = &bodies::generated()[0];
    let mut pose = case.poses().swap_remove(0);
    let world_from_model = case.world_from_model();
    let ray = Ray::new(DVec3::new(0.5, 0.25, 5.0), DVec3::NEG_Z, f64::INFINITY).unwrap();
    let (mut query, mut hits) = (RayQuery::new(), Vec::new());
    query.all(Body::new(&mut pose, &world_from_model), &ray, &mut hits);
    let all = query.stats();
    assert!(query.any(Body::new(&mut pose, &world_from_model), &ray) && hits.len() > 1);
    assert!(query.stats().triangle_tests < all.triangle_tests);
}

#[test]
fn the_length_of_the_direction_scales_only_t() {
    let case = &bodies::generated()[2];
    let mut pose = case.poses().swap_remove(0);
    let world_from_model = case.world_from_model();
    let (origin, direction) = (DVec3::new(0.4, 0.3, 5.0), DVec3::new(0.01, 0.0, -1.0));
    let mut cast = |factor: f64| {
        let ray = Ray::new(origin, direction * factor, f64::INFINITY).unwrap();
        RayQuery::new()
            .closest(Body::new(&mut pose, &world_from_model), &ray)
            .unwrap()
    };
    let one = cast(1.0);
    for factor in [1024.0, 2_f64.powi(-600), 2_f64.powi(900)] {
        let other = cast(factor);
        assert_eq!(
            (other.triangle, other.point, other.distance),
            (one.triangle, one.point, one.distance)
        );
        assert_eq!(other.t * factor, one.t);
    }
}

#[test]
fn a_ray_from_far_away_hits_what_it_is_aimed_at() {
    let case = &bodies::generated()[1];
    let triangles = case.world_triangles();
    let world_from_model = case.world_from_model();
    for pose in &mut case.poses() {
        for (number, triangle) in triangles.iter().enumerate().step_by(7) {
            let origin = DVec3::new(1e9, -3e9, 2e9);
            let target = at([0.3, 0.3, 0.4], triangle);
            let ray = Ray::new(origin, target - origin, f64::INFINITY).unwrap();
            let mut hits = Vec::new();
            RayQuery::new().all(Body::new(pose, &world_from_model), &ray, &mut hits);
            assert!(
                hits.iter()
                    .any(|hit| point_triangle(target, &triangles[hit.triangle as usize]) < 1e-5),
                "{number}"
            );
        }
    }
}

#[test]
fn hits_where_the_ray_starts_are_at_zero_in_the_order_of_triangles() {
    let corners = vec![glam::Vec3::ZERO, glam::Vec3::Y, glam::Vec3::Z];
    let mesh = MorphMesh::rigid("corner", corners, vec![[0, 1, 2], [0, 0, 0], [2, 1, 0]]);
    let case = Case::new("corner", mesh, Vec::new(), glam::Affine3A::IDENTITY);
    let world_from_model = case.world_from_model();
    for pose in &mut case.poses() {
        for direction in [DVec3::X, DVec3::NEG_X, DVec3::NEG_Y] {
            let ray = Ray::new(DVec3::ZERO, direction, 1.0).unwrap();
            let mut hits = Vec::new();
            RayQuery::new().all(Body::new(pose, &world_from_model), &ray, &mut hits);
            let found: Vec<_> = hits
                .iter()
                .map(|hit| (hit.triangle, hit.t.to_bits(), hit.distance.to_bits()))
                .collect();
            assert_eq!(found, [(0, 0, 0), (1, 0, 0), (2, 0, 0)], "along {direction}");
        }
    }
}

/// Triangles with the same corners in another order, and triangles with a common edge or corner, are at the same distance.
#[test]
fn hits_at_the_same_point_come_in_the_order_of_triangles() {
    let blob = morph_collision_models::generated::random::random_blob(3, 1, 2, 0.0);
    let turned = |[a, b, c]: [u32; 3]| [[a, b, c], [c, a, b], [b, a, c], [c, b, a]];
    let triangles = blob.triangles.iter().flat_map(|corners| turned(*corners));
    let mesh = MorphMesh {
        triangles: triangles.collect(),
        ..blob
    };
    for (name, world_from_model) in bodies::odd_places().into_iter().take(4) {
        let case = Case::new(name, mesh.clone(), vec![0.3, -0.2], world_from_model);
        let (triangles, world_from_model) = (case.world_triangles(), case.world_from_model());
        let mut random = Random(23);
        let around = box_around(&triangles);
        let (mut shared, mut poses) = (0, case.poses());
        for number in (0..triangles.len()).step_by(3) {
            let [a, b, c] = triangles[number];
            for target in [a, 0.5 * (a + b), at([0.2, 0.5, 0.3], &[a, b, c])] {
                let origin = random.around(around);
                let ray = Ray::new(origin, target - origin, f64::INFINITY).unwrap();
                for pose in &mut poses {
                    let mut hits = Vec::new();
                    RayQuery::new().all(Body::new(pose, &world_from_model), &ray, &mut hits);
                    assert!(hits.is_sorted_by_key(|hit| Rank::new(hit.t, hit.triangle)));
                    let four = hits.chunk_by(|x, y| x.triangle / 4 == y.triangle / 4);
                    for copies in four.filter(|copies| copies.len() == 4) {
                        assert!(copies.iter().all(|hit| hit.t == copies[0].t), "{name}: {copies:?}");
                        shared += 1;
                    }
                    // Where it hits a corner or an edge, it hits several triangles at once.
                    let closest = RayQuery::new().closest(Body::new(pose, &world_from_model), &ray);
                    assert_eq!(closest, hits.first().copied(), "{name}");
                    let truth = hits
                        .iter()
                        .map(|hit| oracle::ray_parameter(origin, target - origin, &triangles[hit.triangle as usize]));
                    assert!(truth.eq(hits.iter().map(|hit| Some(hit.t))), "{name}");
                }
            }
        }
        assert!(shared > 500, "{name}: {shared}");
    }
}

/// In units of so short a direction, all parameters are infinite.
#[test]
fn hits_come_nearest_first_even_if_their_parameters_are_out_of_range() {
    let case = &bodies::generated()[1];
    let world_from_model = case.world_from_model();
    let origin = DVec3::new(0.5, 0.25, 5.0);
    for pose in &mut case.poses() {
        let mut cast = |length: f64| {
            let ray = Ray::new(origin, DVec3::NEG_Z * length, f64::INFINITY).unwrap();
            let mut hits = Vec::new();
            RayQuery::new().all(Body::new(pose, &world_from_model), &ray, &mut hits);
            let closest = RayQuery::new().closest(Body::new(pose, &world_from_model), &ray);
            assert_eq!(closest, hits.first().copied());
            hits.iter().map(|hit| hit.triangle).collect::<Vec<_>>()
        };
        let usual = cast(1.0);
        assert!(usual.len() > 1 && !usual.is_sorted(), "{usual:?}");
        assert_eq!(cast(5e-324), usual);
    }
}

#[test]
fn a_point_is_in_a_closed_mesh_if_triangles_surround_it() {
    let mut random = Random(17);
    let (mut inside, mut outside) = (0, 0);
    for case in bodies::generated() {
        // The other bodies have no inside: they are open, or their transform flattens them.
        let is_solid = [
            "blob at",
            "blob turned",
            "blob sheared",
            "blob mirrored",
            "blob strongly",
            "dolphin",
        ];
        if !is_solid.iter().any(|name| case.name.starts_with(name)) {
            continue;
        }
        let (triangles, world_from_model) = (case.world_triangles(), case.world_from_model());
        let around = box_around(&triangles);
        for mut pose in case.poses() {
            for i in 0..60 {
                let corner = triangles[random.below(triangles.len())][0];
                let middle = around.0.midpoint(around.1);
                let point = if i % 2 == 0 {
                    random.around(around)
                } else {
                    corner.lerp(middle, random.unit())
                };
                // The solid angles of the triangles add up to 4 pi for each time that they surround the point.
                let solid_angle = |[a, b, c]: &Corners| {
                    let [a, b, c] = [*a - point, *b - point, *c - point];
                    let [x, y, z] = [a.length(), b.length(), c.length()];
                    let volume = a.dot(b.cross(c));
                    2.0 * volume.atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
                };
                let winding = triangles.iter().map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI);
                assert!((winding - winding.round()).abs() < 1e-6, "{} is not closed", case.name);
                let expected = winding.round() != 0.0;
                let found = RayQuery::new()
                    .encloses(Body::new(&mut pose, &world_from_model), point)
                    .unwrap();
                assert_eq!(found, expected, "{} at {point}: {winding}", case.name);
                *(if found { &mut inside } else { &mut outside }) += 1;
            }
            // A corner is on the surface.
            let corner = triangles[0][0];
            assert!(
                RayQuery::new()
                    .encloses(Body::new(&mut pose, &world_from_model), corner)
                    .unwrap(),
                "{}",
                case.name
            );
        }
    }
    assert!(inside > 50 && outside > 50, "{inside} {outside}");
    let case = &bodies::generated()[0];
    let (world_from_model, mut pose) = (case.world_from_model(), case.poses().swap_remove(0));
    assert!(
        RayQuery::new()
            .encloses(Body::new(&mut pose, &world_from_model), DVec3::NAN)
            .is_err()
    );
}
