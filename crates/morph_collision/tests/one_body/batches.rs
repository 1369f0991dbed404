//! Batches of questions about one body, on any number of threads, compared with one question at a time.

use std::fmt::Debug;

use glam::{DVec3, Vec3};
use morph_collision::batch::{ThreadWorkers, Workers};
use morph_collision::{Body, InputError, PlacedShape, Pose, Ray, RayQuery, ShapeQuery, WorldFromModel};
use morph_collision_models::generated::random::random_blob;

use crate::bodies::{self, Case, Random, box_around};

/// Workers that call each other one after the other, in the other order.
struct Backwards(usize);

impl Workers for Backwards {
    fn count(&self) -> usize {
        self.0
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        (0..self.0).rev().for_each(work);
    }
}

/// A body, and what it is asked.
struct Asked {
    name: String,
    pose: Pose,
    place: WorldFromModel,
    points: Vec<DVec3>,
}

impl Asked {
    fn new(case: &Case, count: usize) -> Self {
        let bounds = box_around(&case.world_triangles());
        let mut random = Random(29);
        let points = (0..count).map(|index| match index % 16 {
            0 => 1e5 * random.point(),
            1 => bounds.0,
            2 => DVec3::splat(1e50),
            _ => random.around(bounds),
        });
        Self {
            name: case.name.clone(),
            points: points.collect(),
            pose: case.poses().swap_remove(0),
            place: case.world_from_model(),
        }
    }

    /// Rays from point to point. Some have no length, others no end.
    fn rays(&self) -> Vec<Ray> {
        let ends = self.points.iter().zip(self.points.iter().cycle().skip(5)).zip(0..);
        let ray = |((from, to), index): ((&DVec3, &DVec3), usize)| {
            let max_t = [f64::INFINITY, 1.0, 0.0, 0.3][index % 4];
            let direction = if from == to { DVec3::X } else { *to - *from };
            Ray::new(*from, direction * [1.0, 1e-20, 1e30][index % 3], max_t).unwrap()
        };
        ends.map(ray).collect()
    }

    /// Balls and points, boxes, and half-spaces.
    fn shapes(&self) -> Vec<PlacedShape> {
        use morph_collision::Shape;
        let near = self.points.iter().filter(|point| point.abs().max_element() < 1e30);
        let shape = |(point, index): (&DVec3, usize)| {
            let shape = match index % 4 {
                0 => Shape::Ball { radius: 0.0 },
                1 => Shape::Ball { radius: 0.3 },
                2 => Shape::Cuboid {
                    half_extents: Vec3::new(0.1, 0.2, 0.0),
                },
                _ => Shape::HalfSpace { normal: Vec3::Y },
            };
            PlacedShape::new(shape, glam::Quat::from_rotation_x(index as f32), point.as_vec3()).unwrap()
        };
        near.zip(0..).map(shape).collect()
    }

    /// Asks one by one and in batches on several threads, twice each, and compares. The poses of batches are fresh for the first time.
    fn compare<T: Clone + Debug>(
        &self,
        count: usize,
        junk: T,
        mut single: impl FnMut(Body<'_>, usize) -> T,
        mut batch: impl FnMut(Body<'_>, &dyn Workers, &mut Vec<T>),
    ) {
        let mut pose = self.pose.clone();
        let expected: Vec<_> = (0..count)
            .map(|index| single(Body::new(&mut pose, &self.place), index))
            .collect();
        // `{:?}` tells every bit, also of -0 and NaN.
        let expected = format!("{expected:?}");
        // Whatever is in the list is replaced.
        let mut answers = vec![junk; 7];
        for workers in [
            &ThreadWorkers::new(1) as &dyn Workers,
            &ThreadWorkers::new(2),
            &ThreadWorkers::new(5),
            &Backwards(3),
        ] {
            let mut pose = self.pose.clone();
            for _ in 0..2 {
                batch(Body::new(&mut pose, &self.place), workers, &mut answers);
                assert!(
                    format!("{answers:?}") == expected,
                    "{}: {} workers",
                    self.name,
                    workers.count()
                );
            }
        }
    }

    fn compare_closest_points(&self, most: f64) {
        let points = &self.points;
        let (mut single, mut many) = (ShapeQuery::new(), ShapeQuery::new());
        self.compare(
            points.len(),
            None,
            |body, index| single.closest_point(body, points[index], most).unwrap(),
            |body, workers, closest| many.closest_point_batch(body, points, most, workers, closest).unwrap(),
        );
    }

    fn compare_all(&self) {
        let (rays, shapes, points) = (self.rays(), self.shapes(), &self.points);
        let (mut single, mut many) = (RayQuery::new(), RayQuery::new());
        self.compare(
            rays.len(),
            None,
            |body, index| single.closest(body, &rays[index]),
            |body, workers, hits| many.closest_batch(body, &rays, workers, hits),
        );
        self.compare(
            rays.len(),
            true,
            |body, index| single.any(body, &rays[index]),
            |body, workers, are_hits| many.any_batch(body, &rays, workers, are_hits),
        );
        self.compare(
            points.len(),
            true,
            |body, index| single.encloses(body, points[index]).unwrap(),
            |body, workers, are_inside| many.encloses_batch(body, points, workers, are_inside).unwrap(),
        );
        let (mut single, mut many) = (ShapeQuery::new(), ShapeQuery::new());
        for most in [f64::INFINITY, 0.2, 0.0] {
            self.compare_closest_points(most);
            self.compare(
                shapes.len(),
                None,
                |body, index| single.closest(body, &shapes[index], most).unwrap(),
                |body, workers, contacts| many.closest_batch(body, &shapes, most, workers, contacts).unwrap(),
            );
        }
        self.compare(
            shapes.len(),
            true,
            |body, index| single.any(body, &shapes[index]),
            |body, workers, are_met| many.any_batch(body, &shapes, workers, are_met),
        );
    }
}

#[test]
fn a_batch_answers_as_one_by_one_on_generated_bodies() {
    for case in bodies::generated() {
        Asked::new(&case, 40).compare_all();
    }
}

#[test]
fn a_batch_answers_as_one_by_one_on_real_models() {
    for case in bodies::real() {
        Asked::new(&case, 25).compare_all();
    }
}

/// A body so large that the work of many questions is spread over threads.
fn large(questions: usize) -> Asked {
    let mesh = random_blob(3, 4, 2, 0.3);
    Asked::new(
        &Case::new("large", mesh, vec![0.7, -0.4], glam::Affine3A::IDENTITY),
        questions,
    )
}

#[test]
fn large_batches_answer_as_one_by_one() {
    // So many that the work is spread.
    large(4000).compare_closest_points(f64::INFINITY);
}

#[test]
fn large_batches_are_spread_over_threads_and_small_ones_are_not() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    struct Counted(AtomicUsize);
    impl Workers for Counted {
        fn count(&self) -> usize {
            2
        }

        fn run(&self, work: &(dyn Fn(usize) + Sync)) {
            self.0.fetch_add(1, Ordering::Relaxed);
            ThreadWorkers::new(2).run(work);
        }
    }
    let Asked {
        mut pose,
        place,
        points,
        ..
    } = large(4000);
    let mut runs = |points: &[DVec3]| {
        let counted = Counted(AtomicUsize::new(0));
        let body = Body::new(&mut pose, &place);
        ShapeQuery::new()
            .closest_point_batch(body, points, f64::INFINITY, &counted, &mut Vec::new())
            .unwrap();
        counted.0.into_inner()
    };
    assert_eq!([runs(&points), runs(&points[..200])], [1, 0]);
    // They are many, but no work: all bounds are farther away.
    let far = vec![DVec3::splat(1e6); 4000];
    let counted = Counted(AtomicUsize::new(0));
    let mut closest = Vec::new();
    ShapeQuery::new()
        .closest_point_batch(Body::new(&mut pose, &place), &far, 1.0, &counted, &mut closest)
        .unwrap();
    assert_eq!((closest, counted.0.into_inner()), (vec![None; 4000], 0));
}

#[test]
fn a_batch_works_less_than_one_by_one() {
    let Asked {
        mut pose,
        place,
        points,
        ..
    } = large(4000);
    let mut query = ShapeQuery::new();
    let mut one_by_one = 0;
    for point in &points {
        let body = Body::new(&mut pose, &place);
        query.closest_point(body, *point, f64::INFINITY).unwrap();
        one_by_one += query.stats().triangle_tests;
    }
    let body = Body::new(&mut pose, &place);
    let one_thread = ThreadWorkers::new(1);
    query
        .closest_point_batch(body, &points, f64::INFINITY, &one_thread, &mut Vec::new())
        .unwrap();
    let batch = query.stats().triangle_tests;
    assert!(batch > 0 && batch <= one_by_one, "{batch}, not {one_by_one}");
}

#[test]
fn a_bad_question_is_named_and_nothing_is_answered() {
    let Asked {
        mut pose,
        place,
        mut points,
        ..
    } = large(4000);
    points[77].y = f64::NAN;
    points[99].x = f64::INFINITY;
    let (mut rays, mut shapes, one_thread) = (RayQuery::new(), ShapeQuery::new(), ThreadWorkers::new(1));
    let message = |answer: Result<(), InputError>| answer.unwrap_err().to_string();
    let mut closest = vec![None; 3];
    let body = Body::new(&mut pose, &place);
    let bad = message(shapes.closest_point_batch(body, &points, 1.0, &one_thread, &mut closest));
    assert!(bad.starts_with("point 77: coordinate 1 is NaN"), "{bad}");
    let mut are_inside = vec![true; 3];
    let body = Body::new(&mut pose, &place);
    let bad = message(rays.encloses_batch(body, &points, &one_thread, &mut are_inside));
    assert!(bad.starts_with("point 77: coordinate 1 is NaN"), "{bad}");
    let body = Body::new(&mut pose, &place);
    let bad = message(shapes.closest_point_batch(body, &points[..9], -1.0, &one_thread, &mut closest));
    assert!(bad.contains("max_distance"), "{bad}");
    let body = Body::new(&mut pose, &place);
    let bad = message(shapes.closest_batch(body, &[], f64::NAN, &one_thread, &mut Vec::new()));
    assert!(bad.contains("within"), "{bad}");
    assert_eq!((closest, are_inside), (vec![None; 3], vec![true; 3]));
}

#[test]
fn no_questions_have_no_answers() {
    let Asked { mut pose, place, .. } = large(400);
    let (mut rays, mut shapes, threads) = (RayQuery::new(), ShapeQuery::new(), ThreadWorkers::new(2));
    let (mut hits, mut closest) = (vec![None; 3], vec![None; 3]);
    rays.closest_batch(Body::new(&mut pose, &place), &[], &threads, &mut hits);
    let body = Body::new(&mut pose, &place);
    shapes
        .closest_point_batch(body, &[], 1.0, &threads, &mut closest)
        .unwrap();
    assert!(hits.is_empty() && closest.is_empty());
    assert_eq!((rays.stats(), shapes.stats()), Default::default());
}
