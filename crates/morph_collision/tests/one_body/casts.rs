//! Shape casts, checked against distances from triangles that are measured along the path.

use std::sync::Arc;

use glam::{Affine3A, DVec3, EulerRot, Quat, Vec3};
use morph_collision::{Body, ConvexHull, PlacedShape, Shape, ShapeQuery, WorldFromModel};

use crate::bodies::{self, Case, Random, box_around};
use crate::reference::{Corners, point_triangle, touch};

const WAYS: usize = 2;

/// A shape for casts, whose distance from a triangle is computed from sampled points and face triangles.
struct Moving {
    shape: Shape,
    rotation: Quat,
}

impl Moving {
    fn all(random: &mut Random, size: f64) -> Vec<Self> {
        let mut length = || (size * (0.02 + 0.2 * random.unit())) as f32;
        let shapes = [
            Shape::Ball { radius: length() },
            Shape::Ball { radius: 0.0 },
            Shape::Capsule {
                half_length: length(),
                radius: length(),
            },
            Shape::Cuboid {
                half_extents: Vec3::new(length(), length(), length()),
            },
            Shape::Cylinder {
                half_height: length(),
                radius: length(),
            },
            Shape::ConicalFrustum {
                half_height: length(),
                bottom_radius: 2.0 * length(),
                top_radius: length(),
            },
            Shape::ConvexHull(Arc::new(
                ConvexHull::new(&[
                    Vec3::ZERO,
                    Vec3::X * length(),
                    Vec3::Y * length(),
                    Vec3::new(length(), -length(), length()),
                ])
                .unwrap(),
            )),
        ];
        let turn = |shape| Self {
            shape,
            rotation: Quat::from_euler(
                EulerRot::XYZ,
                random.unit() as f32 * 6.0,
                random.unit() as f32 * 6.0,
                0.3,
            ),
        };
        shapes.map(turn).into_iter().collect()
    }

    fn placed(&self, at: DVec3) -> PlacedShape {
        PlacedShape::new(self.shape.clone(), self.rotation, at.as_vec3()).unwrap()
    }

    /// The distance of a triangle from the shape at `at`, from many sampled points: an upper bound, and by how much it is too large at
    /// most.
    fn distance(&self, at: DVec3, triangle: &Corners) -> (f64, f64) {
        let turned = |point: Vec3| at + self.rotation.as_dquat().normalize() * point.as_dvec3();
        match self.shape {
            Shape::Ball { radius } => (point_triangle(at, triangle) - f64::from(radius), 0.0),
            Shape::Capsule { half_length, radius } => {
                let points = (-32..=32).map(|i| turned(Vec3::Y * half_length * (i as f32 / 32.0)));
                let nearest = points
                    .map(|p| point_triangle(p, triangle))
                    .fold(f64::INFINITY, f64::min);
                (nearest - f64::from(radius), f64::from(half_length) / 32.0)
            }
            Shape::Cuboid { half_extents } => {
                let corners = (0..8).map(|i| {
                    let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
                    turned(half_extents * Vec3::new(sign(1), sign(2), sign(4)))
                });
                let corners: Vec<_> = corners.collect();
                let faces = [
                    [0, 1, 3, 2],
                    [4, 5, 7, 6],
                    [0, 1, 5, 4],
                    [2, 3, 7, 6],
                    [0, 2, 6, 4],
                    [1, 3, 7, 5],
                ];
                let halves = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
                let faces = halves.map(|half| half.map(|i| corners[i]));
                (sampled(faces, triangle), f64::from(half_extents.max_element()) / 8.0)
            }
            Shape::ConvexHull(ref hull) => {
                let corner = |i: u32| at + self.rotation.as_dquat().normalize() * hull.points()[i as usize];
                let faces = hull.faces().iter().map(|face| face.map(corner));
                let size = hull.points().iter().map(|p| p.length()).fold(0.0, f64::max);
                (sampled(faces, triangle), size / 8.0)
            }
            Shape::Cylinder { half_height, radius } => {
                let shape = Shape::ConicalFrustum {
                    half_height,
                    bottom_radius: radius,
                    top_radius: radius,
                };
                let rotation = self.rotation;
                Self { shape, rotation }.distance(at, triangle)
            }
            Shape::ConicalFrustum {
                half_height,
                bottom_radius,
                top_radius,
            } => {
                const SIDES: usize = 24;
                let rim = |i: usize, radius: f32, y: f32| {
                    let (sin, cos) = (i as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
                    turned(Vec3::new(radius * cos, y, radius * sin))
                };
                let (bottom, top) = (turned(Vec3::NEG_Y * half_height), turned(Vec3::Y * half_height));
                let faces = (0..SIDES).flat_map(|i| {
                    let [a, b] = [i, i + 1].map(|i| rim(i, bottom_radius, -half_height));
                    let [c, d] = [i, i + 1].map(|i| rim(i, top_radius, half_height));
                    [[a, b, c], [b, d, c], [a, b, bottom], [c, d, top]]
                });
                let size = f64::from(half_height.max(bottom_radius).max(top_radius));
                (sampled(faces, triangle), size / 8.0 + 0.01 * size)
            }
            Shape::RoundCuboid { .. } | Shape::Cone { .. } | Shape::HalfSpace { .. } => {
                unreachable!("none is cast here")
            }
        }
    }
}

/// The distance of a triangle from sampled points of others.
fn sampled(faces: impl Iterator<Item = Corners>, triangle: &Corners) -> f64 {
    let mut nearest = f64::INFINITY;
    for face in faces {
        if touch(&face, triangle) {
            return 0.0;
        }
        for p in triangle {
            nearest = nearest.min(point_triangle(*p, &face));
        }
        for p in face {
            nearest = nearest.min(point_triangle(p, triangle));
        }
        for (p, q) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (face[i], face[j])) {
            for k in 0..=16 {
                nearest = nearest.min(point_triangle(p.lerp(q, f64::from(k) / 16.0), triangle));
            }
        }
    }
    nearest
}

fn check(case: &Case, random: &mut Random) -> [usize; 3] {
    let triangles = case.world_triangles();
    let (min, max) = box_around(&triangles);
    let size = (max - min).max_element().max(0.5);
    let coordinates = size + min.abs().max(max.abs()).max_element();
    let world_from_model = case.world_from_model();
    let mut poses = case.poses();
    let mut query = ShapeQuery::new();
    let mut counts = [0; 3];
    for _ in 0..WAYS {
        for moving in Moving::all(random, size) {
            let from = random.around((min, max)).as_vec3().as_dvec3();
            let direction = (random.around((min, max)) - from).normalize_or(DVec3::X);
            let within = size * (0.5 + 3.0 * random.unit());
            let shape = moving.placed(from);
            let hits: Vec<_> = poses
                .iter_mut()
                .map(|pose| {
                    query
                        .cast(Body::new(pose, &world_from_model), &shape, direction * 0.5, within)
                        .unwrap()
                })
                .collect();
            assert!(hits.iter().all(|hit| hit == &hits[0]), "{}: {hits:?}", case.name);
            let hit = hits[0];
            let nearest = |distance: f64| {
                let at = from + direction * distance;
                let all = triangles.iter().map(|triangle| moving.distance(at, triangle));
                all.fold(
                    (f64::INFINITY, 0.0),
                    |best, one| if one.0 < best.0 { one } else { best },
                )
            };
            let name = format!(
                "{} {:?} from {from} along {direction}: {hit:?}",
                case.name, moving.shape
            );
            let free = hit.map_or(within, |hit| hit.impact.distance);
            for step in 0..12 {
                let distance = free * f64::from(step) / 12.0;
                // All sampled points are in the shape, so none of them may touch earlier.
                assert!(
                    free == 0.0 || nearest(distance).0 > -1e-9 * coordinates,
                    "{name}: {distance}"
                );
                if matches!(moving.shape, Shape::Ball { .. } | Shape::Cuboid { .. }) {
                    assert!(
                        free == 0.0 || nearest(distance).0 > 0.0,
                        "{name}: touches at {distance}"
                    );
                }
            }
            let Some(hit) = hit else {
                counts[0] += 1;
                continue;
            };
            counts[if hit.impact.distance > 0.0 { 1 } else { 2 }] += 1;
            let (distance, too_much) = moving.distance(
                from + direction * hit.impact.distance,
                &triangles[hit.triangle as usize],
            );
            assert!(
                distance - too_much < 1e-9 * coordinates,
                "{name}: {distance} {too_much}"
            );
            let on_it = point_triangle(hit.impact.point, &triangles[hit.triangle as usize]);
            assert!(
                on_it < 1e-9 * coordinates,
                "{name}: the point is {on_it} off the triangle"
            );
            if hit.impact.distance > 0.0 {
                let moved = moving.placed(DVec3::ZERO);
                let local = hit.impact.point - from - direction * hit.impact.distance;
                assert!(
                    moved.signed_distance(local).abs() < 1e-6 * coordinates,
                    "{name}: off the shape"
                );
                assert!(hit.impact.normal.dot(direction) < 1e-9 && (hit.impact.normal.length() - 1.0).abs() < 1e-9);
            }
        }
    }
    counts
}

#[test]
fn nothing_is_touched_before_the_hit_and_something_then() {
    let mut random = Random(5);
    let mut counts = [0; 3];
    for case in bodies::generated() {
        let of_this = check(&case, &mut random);
        counts = [0, 1, 2].map(|i| counts[i] + of_this[i]);
    }
    assert!(
        counts.iter().all(|&count| count > 20),
        "misses, hits, touching at the start: {counts:?}"
    );
}

#[test]
fn casts_that_pass_far_away_look_at_next_to_nothing() {
    let case = &bodies::generated()[0];
    let world_from_model = WorldFromModel::new(Affine3A::from_translation(Vec3::splat(500.0))).unwrap();
    let mut pose = case.poses().swap_remove(0);
    let ball = PlacedShape::ball(DVec3::splat(1000.0), 1.0).unwrap();
    let two = PlacedShape::compound(&[ball.clone(), ball]).unwrap();
    let mut query = ShapeQuery::new();
    for direction in DVec3::AXES.map(|axis| -axis) {
        let body = Body::new(&mut pose, &world_from_model);
        assert_eq!(query.cast(body, &two, direction, f64::INFINITY).unwrap(), None);
        assert!(query.stats().node_tests <= 8, "{:?}", query.stats());
    }
}

#[test]
fn bad_casts_are_refused() {
    let case = &bodies::generated()[0];
    let (world_from_model, mut pose) = (case.world_from_model(), case.poses().swap_remove(0));
    let ball = PlacedShape::ball(DVec3::ZERO, 1.0).unwrap();
    for (direction, within) in [
        (DVec3::ZERO, 1.0),
        (DVec3::NAN, 1.0),
        (DVec3::X, -1.0),
        (DVec3::X, f64::NAN),
    ] {
        let cast = ShapeQuery::new().cast(Body::new(&mut pose, &world_from_model), &ball, direction, within);
        assert!(cast.is_err(), "{direction} {within}");
    }
}
