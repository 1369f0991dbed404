//! Points and balls that move, checked against every triangle.

use std::sync::Arc;

use glam::DVec3;
use morph_collision::motion::{MotionQuery, MovingBall, MovingPoint, TimeOfImpact, vertex_face_impact};
use morph_collision_testkit::oracle::point_distance;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::bodies::{Step, TOLERANCE, model, vector};

/// Of a query in `f64`, relative to the size of the scene.
const ROUNDING: f64 = 1e-9;

pub(super) fn at(point: &MovingPoint, time: f64) -> DVec3 {
    point.start * (1.0 - time) + point.end * time
}

/// A body that moves from one place to another, and its triangles.
pub(super) struct Scene {
    pub(super) body: Step,
    pub(super) triangles: Vec<[MovingPoint; 3]>,
}

impl Scene {
    pub(super) fn new(rng: &mut Pcg64Mcg, far: DVec3) -> Self {
        let is_skinned = rng.random_bool(0.3);
        let model = Arc::new(model(rng, is_skinned));
        let leaf_size = [1, 3, 8, 20][rng.random_range(0..4)];
        let places = [(); 2].map(|()| far.as_vec3() + vector(rng, 2.0));
        let mut body = Step::new(rng, &model, leaf_size, places);
        let points = body.points();
        let faces = body.faces().into_iter();
        Self {
            triangles: faces.map(|face| face.map(|vertex| points[vertex as usize])).collect(),
            body,
        }
    }

    /// The distance between a point and the triangles at a time.
    fn distance(&self, center: &MovingPoint, time: f64) -> f64 {
        let distances = self
            .triangles
            .iter()
            .map(|triangle| point_distance(at(center, time), &triangle.map(|corner| at(&corner, time))));
        distances.fold(f64::INFINITY, f64::min)
    }

    /// A motion through the scene, beside it, or with it.
    fn path(&self, rng: &mut Pcg64Mcg, far: DVec3) -> MovingPoint {
        let size = [6.0, 6.0, 60.0][rng.random_range(0..3)];
        let [start, end] = [(); 2].map(|()| far + vector(rng, size).as_dvec3());
        match rng.random_range(0..6) {
            0 => MovingPoint::resting(start),
            // Starts on a vertex.
            1 => MovingPoint::new(self.triangles[0][0].start, end),
            _ => MovingPoint::new(start, end),
        }
    }
}

pub(super) fn far(rng: &mut Pcg64Mcg) -> DVec3 {
    if rng.random_bool(0.2) {
        vector(rng, 1e4).as_dvec3()
    } else {
        DVec3::ZERO
    }
}

#[test]
fn a_point_touches_where_the_exact_tests_of_all_faces_say() {
    let mut rng = Pcg64Mcg::seed_from_u64(71);
    let (mut query, mut touching, mut apart, mut tests) = (MotionQuery::new(), 0, 0, 0);
    for case in 0..40 {
        let far = far(&mut rng);
        let mut scene = Scene::new(&mut rng, far);
        for _ in 0..20 {
            let path = scene.path(&mut rng, far);
            let times = scene.triangles.iter().enumerate().filter_map(|(triangle, face)| {
                let time = vertex_face_impact(path, *face, TOLERANCE)?;
                Some((time.latest, time.earliest, triangle as u32))
            });
            let truth = times.min_by(|x, y| x.partial_cmp(y).unwrap());
            let ball = MovingBall::new(path, 0.0).unwrap();
            let found = query.first_of_ball(&ball, scene.body.moving(), TOLERANCE).unwrap();
            tests += query.stats().feature_tests;
            let answer = found.map(|impact| (impact.time.latest, impact.time.earliest, impact.triangle));
            assert_eq!(answer, truth, "case {case}, {path:?}");
            touching += usize::from(truth.is_some());
            apart += usize::from(truth.is_none());
            let Some(impact) = found else { continue };
            let middle = impact.time.earliest.midpoint(impact.time.latest);
            assert_eq!(impact.point, at(&path, middle));
            assert!((impact.normal.length() - 1.0).abs() < ROUNDING || impact.normal == DVec3::ZERO);
            if impact.time.latest > 0.0 {
                assert!(
                    impact.normal.dot(impact.velocity) <= ROUNDING * impact.velocity.length(),
                    "{impact:?}"
                );
            }
        }
    }
    println!("{touching} points touch, {apart} do not, {tests} faces tested");
    assert!(touching > 100 && apart > 100, "{touching} touch, {apart} do not");
    assert!(tests < 40 * 20 * 120 / 4, "{tests} faces tested");
}

#[test]
fn a_ball_does_not_touch_before_the_time_returned_and_does_then() {
    let mut rng = Pcg64Mcg::seed_from_u64(72);
    let (mut query, mut touching, mut apart) = (MotionQuery::new(), 0, 0);
    for case in 0..24 {
        let far = far(&mut rng);
        let mut scene = Scene::new(&mut rng, far);
        for _ in 0..10 {
            let path = scene.path(&mut rng, far);
            let radius = [1e-3, 0.1, 0.5, 2.0][rng.random_range(0..4)];
            let rounding = ROUNDING * (1.0 + far.length());
            let ball = MovingBall::new(path, radius).unwrap();
            let found = query.first_of_ball(&ball, scene.body.moving(), TOLERANCE).unwrap();
            // One that touches at the start has no time before.
            let until = found.map_or(1.0, |impact| impact.time.earliest);
            let touches_at_once = found.is_some_and(|impact| impact.time.latest == 0.0);
            // The moments at which the ball comes closest are searched between samples.
            let samples = 200;
            let time = |sample: f64| until * sample / f64::from(samples);
            for sample in 0..=samples {
                let (mut low, mut high) = (f64::from(sample) - 1.0, f64::from(sample) + 1.0);
                for _ in 0..4 {
                    let third = (high - low) / 3.0;
                    let (left, right) = (low + third, high - third);
                    let [at_left, at_right] =
                        [left, right].map(|sample| scene.distance(&path, time(sample.clamp(0.0, f64::from(samples)))));
                    // Up to this error, it is just not there yet.
                    assert!(
                        touches_at_once || at_left.min(at_right) > radius - rounding,
                        "case {case}, {ball:?}, {found:?}"
                    );
                    if at_left < at_right {
                        high = right;
                    } else {
                        low = left;
                    }
                }
            }
            touching += usize::from(found.is_some());
            apart += usize::from(found.is_none());
            let Some(impact) = found else { continue };
            let TimeOfImpact { earliest, latest } = impact.time;
            assert!(latest - earliest <= TOLERANCE && (0.0..=latest).contains(&earliest) && latest <= 1.0);
            let distance = scene.distance(&path, latest);
            let moved = impact.velocity.length() * TOLERANCE + 1e-6;
            assert!(
                distance <= radius + moved + rounding,
                "case {case}, {distance}, {impact:?}"
            );
            // The geometry is that of the triangle at the middle of the interval.
            let middle = earliest.midpoint(latest);
            let corners = scene.triangles[impact.triangle as usize].map(|corner| at(&corner, middle));
            let weighted = corners.iter().zip(impact.barycentrics);
            let on_triangle = weighted.fold(DVec3::ZERO, |sum, (corner, weight)| sum + *corner * weight);
            assert!(on_triangle.distance(impact.point) <= rounding, "{impact:?}");
            let to_center = at(&path, middle) - impact.point;
            if to_center.length() > 1e-3 {
                assert!(
                    to_center.normalize().distance(impact.normal) < 1e3 * rounding,
                    "{impact:?}"
                );
            }
        }
    }
    println!("{touching} balls touch, {apart} do not");
    assert!(touching > 40 && apart > 40, "{touching} touch, {apart} do not");
}

#[test]
fn bad_balls_are_rejected() {
    let rest = MovingPoint::resting(DVec3::ZERO);
    for radius in [-1.0, f64::NAN, f64::INFINITY] {
        let error = MovingBall::new(rest, radius).unwrap_err().to_string();
        assert!(error.contains("radius"), "{error}");
    }
    let nowhere = MovingPoint::new(DVec3::ZERO, DVec3::NAN);
    let error = MovingBall::new(nowhere, 1.0).unwrap_err().to_string();
    assert!(error.contains("center at the end"), "{error}");
}
