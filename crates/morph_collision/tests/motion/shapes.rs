//! Shapes that move and turn, compared with each triangle at many times.

use std::sync::Arc;

use glam::{Affine3A, DVec3, EulerRot, Quat, Vec3};
use morph_collision::motion::{MotionQuery, MovingBody, MovingPoint, MovingShape, SurfaceImpact, TimeOfImpact};
use morph_collision::{Body, BuildOptions, ConvexHull, MorphBvh, PlacedShape, Pose, Shape, ShapeQuery, WorldFromModel};
use morph_collision_models::generated::random::random_blob;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::balls::{Scene, at, far};
use super::bodies::{TOLERANCE, vector};

fn shape(rng: &mut Pcg64Mcg, kind: usize) -> Shape {
    let size = [0.02, 0.2, 0.5][rng.random_range(0..3)];
    let mut length = || size * rng.random_range(0.3..2.0_f32);
    match kind {
        0 => Shape::Ball { radius: length() },
        1 => Shape::Capsule {
            half_length: length() * 2.0,
            radius: length(),
        },
        2 => Shape::Cuboid {
            half_extents: Vec3::new(length(), length() * 3.0, length()),
        },
        3 => Shape::RoundCuboid {
            half_extents: Vec3::new(length(), 0.0, length()),
            border_radius: length() * 0.5,
        },
        4 => Shape::Cylinder {
            half_height: length(),
            radius: length(),
        },
        5 => Shape::Cone {
            half_height: length(),
            radius: length(),
        },
        _ => {
            let points: Vec<Vec3> = (0..8)
                .map(|_| vector(rng, size) + Vec3::new(size * 2.0, 0.0, 0.0))
                .collect();
            Shape::ConvexHull(Arc::new(ConvexHull::new(&points).unwrap()))
        }
    }
}

fn placed(rng: &mut Pcg64Mcg, kind: usize, place: Vec3) -> PlacedShape {
    let [x, y, z] = vector(rng, 3.0).to_array();
    PlacedShape::new(shape(rng, kind), Quat::from_euler(EulerRot::XYZ, x, y, z), place).unwrap()
}

fn motion(rng: &mut Pcg64Mcg, kind: usize, far: DVec3) -> MovingShape {
    let offset = vector(rng, 4.0);
    let place = far.as_vec3() + offset;
    let way = match rng.random_range(0..4) {
        0 => DVec3::ZERO,
        1 => vector(rng, 0.5).as_dvec3(),
        // Towards the middle.
        _ => (vector(rng, 1.0) - 1.3 * offset).as_dvec3(),
    };
    let motion = MovingShape::new(placed(rng, kind, place), way).unwrap();
    match rng.random_range(0..4) {
        0 => motion,
        1 => {
            let pivot = place.as_dvec3() + vector(rng, 2.0).as_dvec3();
            motion.turning(pivot, vector(rng, 2.0).as_dvec3()).unwrap()
        }
        _ => {
            let turn = vector(rng, 1.0).as_dvec3() * [0.1, 1.0, 4.0][rng.random_range(0..3)];
            motion.turning(place.as_dvec3(), turn).unwrap()
        }
    }
}

fn touches(shape: &MovingShape, triangles: &[[MovingPoint; 3]], time: f64) -> bool {
    let shape = shape.at(time);
    let mut at_time = triangles
        .iter()
        .map(|triangle| triangle.map(|corner| at(&corner, time)));
    at_time.any(|triangle| shape.intersects(&triangle))
}

#[test]
fn a_shape_does_not_touch_before_the_time_returned_and_does_then() {
    let mut rng = Pcg64Mcg::seed_from_u64(73);
    let (mut query, mut touching, mut apart, mut unclear) = (MotionQuery::new(), 0, 0, 0);
    for case in 0..28 {
        let far = far(&mut rng);
        let mut scene = Scene::new(&mut rng, far);
        for _ in 0..10 {
            let shape = motion(&mut rng, case % 7, far);
            let size = 10.0 + far.length();
            let found = query.first_of_shape(&shape, scene.body.moving(), TOLERANCE).unwrap();
            let until = found.map_or(1.0, |impact| impact.time.earliest);
            for sample in 0..100 {
                let time = until * f64::from(sample) / 100.0;
                let may_touch = found.is_some_and(|impact| time >= impact.time.earliest);
                assert!(
                    may_touch || !touches(&shape, &scene.triangles, time),
                    "case {case} at {time}: {shape:?} {found:?}"
                );
            }
            touching += usize::from(found.is_some());
            apart += usize::from(found.is_none());
            let Some(impact) = found else { continue };
            let TimeOfImpact { earliest, latest } = impact.time;
            assert!((0.0..=latest).contains(&earliest) && latest <= 1.0, "{impact:?}");
            if latest - earliest > TOLERANCE {
                unclear += 1;
                continue;
            }
            let corners = scene.triangles[impact.triangle as usize].map(|corner| at(&corner, latest));
            let weighted = corners.iter().zip(impact.barycentrics);
            let on_triangle = weighted.fold(DVec3::ZERO, |sum, (corner, weight)| sum + *corner * weight);
            let moved = TOLERANCE * (impact.velocity.length() + 30.0);
            assert!(on_triangle.distance(impact.point) <= 1e-9 * size + moved, "{impact:?}");
            let depth = shape.at(latest).signed_distance(impact.point);
            assert!(depth <= 1e-7 * size + moved, "case {case}: {depth} {impact:?}");
            if latest > 0.0 {
                assert!((impact.normal.length() - 1.0).abs() < 1e-9, "{impact:?}");
                assert!(depth > -1e-7 * size - moved, "case {case}: {depth} {impact:?}");
            }
        }
    }
    println!("{touching} shapes touch, {apart} do not, {unclear} are unclear");
    assert!(touching > 60 && apart > 60 && unclear < 5);
}

#[test]
fn casts_that_turn_agree_with_motions_against_a_body_at_rest_and_with_casts_that_do_not() {
    let mut rng = Pcg64Mcg::seed_from_u64(74);
    let mesh = random_blob(3, 2, 1, 0.5);
    let model = Arc::new(mesh.to_model().unwrap());
    let bvh = Arc::new(MorphBvh::build(model, &BuildOptions::default()));
    let world_from_model = WorldFromModel::new(Affine3A::from_scale(Vec3::new(1.0, 2.0, 0.5))).unwrap();
    let [mut start, mut end] = [(); 2].map(|()| Pose::new(bvh.clone()));
    let (mut casts, mut motions) = (ShapeQuery::new(), MotionQuery::new());
    let (mut hits, mut tests) = (0, 0);
    for case in 0..140 {
        let shape = motion(&mut rng, case % 7, DVec3::ZERO);
        let cast = casts.cast_moving(Body::new(&mut start, &world_from_model), &shape, TOLERANCE);
        tests += casts.stats().triangle_tests;
        let [at_start, at_end] = [&mut start, &mut end].map(|pose| Body::new(pose, &world_from_model));
        let body = MovingBody::new(at_start, at_end).unwrap();
        let moved = motions.first_of_shape(&shape, body, TOLERANCE).unwrap();
        let key = |impact: SurfaceImpact| (impact.triangle, impact.time.latest);
        assert_eq!(cast.map(key), moved.map(key), "{shape:?}");
        hits += usize::from(cast.is_some());
    }
    assert!(hits > 30 && tests < 140 * 320 / 2, "{hits} hits, {tests} triangles");
    for case in 0..70 {
        let place = vector(&mut rng, 4.0);
        let way = -2.0 * place.as_dvec3() + vector(&mut rng, 1.0).as_dvec3();
        let still = placed(&mut rng, case % 7, place);
        let shape = MovingShape::new(still.clone(), way).unwrap();
        let moved = casts.cast_moving(Body::new(&mut start, &world_from_model), &shape, 1e-9);
        let body = Body::new(&mut start, &world_from_model);
        let straight = casts.cast(body, &still, way, way.length()).unwrap();
        let times = [
            moved.map(|impact| impact.time.latest),
            straight.map(|hit| hit.impact.distance / way.length()),
        ];
        match times {
            [Some(a), Some(b)] => assert!((a - b).abs() < 1e-6, "{shape:?} {a} {b}"),
            [None, None] => {}
            _ => panic!("{shape:?}: {moved:?} {straight:?}"),
        }
    }
}

#[test]
fn a_motion_between_two_placements_passes_through_both() {
    let mut rng = Pcg64Mcg::seed_from_u64(75);
    for case in 0..70 {
        let kind = case % 7;
        let shape = shape(&mut rng, kind);
        let turn = |rng: &mut Pcg64Mcg| {
            let axis = vector(rng, 1.0).normalize_or(Vec3::X);
            Quat::from_axis_angle(axis, rng.random_range(0.0..1.5))
        };
        let first = turn(&mut rng);
        let rotations = [first, turn(&mut rng) * first];
        let at = [(); 2].map(|()| vector(&mut rng, 3.0));
        let places = [0, 1].map(|i| PlacedShape::new(shape.clone(), rotations[i].normalize(), at[i]).unwrap());
        let motion = MovingShape::between(&places[0], &places[1]).unwrap();
        assert_eq!(motion.at(1.0), places[1]);
        assert!(motion.at(0.0).displacement_from(&places[0]) < 1e-5, "{shape:?}");
        assert!(places[0].displacement_from(&motion.at(0.0)) < 1e-5, "{shape:?}");
        // Of a capsule, only the axis turns, and a hull turns around its own middle.
        if (2..=5).contains(&kind) {
            let half = PlacedShape::new(shape, rotations[0].slerp(rotations[1], 0.5), at[0].lerp(at[1], 0.5)).unwrap();
            assert!(motion.at(0.5).displacement_from(&half) < 1e-5, "{half:?}");
        }
    }
    let ball = PlacedShape::ball(DVec3::ZERO, 1.0).unwrap();
    let cuboid = |half: f32| {
        let half_extents = Vec3::splat(half);
        PlacedShape::new(Shape::Cuboid { half_extents }, Quat::IDENTITY, Vec3::X).unwrap()
    };
    let half_space = PlacedShape::new(Shape::HalfSpace { normal: Vec3::Y }, Quat::IDENTITY, Vec3::X).unwrap();
    assert_eq!(MovingShape::between(&ball, &cuboid(1.0)), None);
    assert_eq!(MovingShape::between(&half_space, &half_space), None);
    // It has its last size all the time.
    assert_eq!(
        MovingShape::between(&cuboid(1.0), &cuboid(2.0)).unwrap().at(0.0),
        cuboid(2.0)
    );
    let error = MovingShape::new(half_space, DVec3::X).unwrap_err();
    assert_eq!(
        error.to_string(),
        "number of half-spaces is 1, it must be 0 in a shape that moves"
    );
    assert!(MovingShape::new(ball.clone(), DVec3::NAN).is_err());
    let still = MovingShape::new(ball, DVec3::ZERO).unwrap();
    assert!(still.clone().turning(DVec3::ZERO, DVec3::X * 1e4).is_err());
    assert!(still.turning(DVec3::INFINITY, DVec3::X).is_err());
}
