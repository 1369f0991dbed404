//! Tests of lower bounds on distances.

use glam::{Affine3A, DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{
    Aabb, BoxLanes, DistanceCull, Keys, LANES, Lanes, LowerBounds, PlacedBounds, WorldFromModel, levels, with_simd,
};
use crate::exact::{
    Segment, Triangle, closest_of_segment_and_triangle, closest_on_segment, closest_on_triangle, common_segment,
};

type CornerLanes = [[Lanes; 3]; 3];

/// The keys of boxes and triangles. They are the same for all instruction sets.
fn keys(cull: &DistanceCull, boxes: &BoxLanes, corners: &CornerLanes) -> [Keys; 2] {
    let of_level = |&level| {
        let mut found = [Keys::default(); 2];
        let [of_boxes, of_triangles] = &mut found;
        with_simd!(level, simd => {
            cull.lower_bounds(simd, boxes, u8::MAX, f32::INFINITY, of_boxes);
            cull.triangles(simd, corners, f32::INFINITY, of_triangles);
        });
        found
    };
    let all: Vec<_> = levels().iter().map(of_level).collect();
    all.iter().for_each(|other| assert_eq!(other, &all[0]));
    all[0]
}

/// A body, and what is asked about it.
struct Situation {
    place: WorldFromModel,
    magnitude: f32,
    segment: Segment,
    radius: f64,
    /// By how much corners are off, along each axis.
    corner_error: f32,
}

fn random(rng: &mut Pcg64Mcg, case: usize) -> Situation {
    let mut vector = |reach: f64| DVec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..reach)));
    let size: f64 = [1.0, 1e-6, 1e6, 1e-25, 1e25][case % 5];
    let turn = Affine3A::from_axis_angle(vector(1.0).normalize().as_vec3(), 1.0);
    let linear = match case % 7 {
        0 => Affine3A::from_scale(Vec3::new(3.0, 0.2, -1.0)),
        // Sheared, then flat: boxes are mapped to the world.
        1 => Affine3A::from_scale(Vec3::new(1.0, 1e-3, 1.0)) * turn,
        2 => Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0)),
        _ => Affine3A::from_scale(Vec3::splat(0.7)),
    };
    let far = [0.0, 1e4 * size, 1e7 * size, 1e13 * size][case % 4];
    let place = Affine3A::from_translation(vector(far.max(f64::MIN_POSITIVE)).as_vec3()) * turn * linear;
    let place = WorldFromModel::new(place).expect("finite");
    let away = [1.0, 1e-3, 20.0, 1e6, 1e15][case / 5 % 5] * size;
    let middle = place.translation() + vector(away);
    let half = if case.is_multiple_of(2) {
        DVec3::ZERO
    } else {
        vector(size)
    };
    Situation {
        place,
        magnitude: size as f32,
        segment: [middle - half, middle + half],
        radius: [0.0, 0.1 * size][case / 2 % 2],
        corner_error: [0.0, 0.0, 1e-2 * size as f32][case / 4 % 3],
    }
}

/// Sizes from subnormal to the largest, in the model and in the world.
fn extreme(rng: &mut Pcg64Mcg, case: usize) -> Situation {
    let mut vector = |reach: f64| DVec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..=reach)));
    let turn = Affine3A::from_axis_angle(vector(1.0).normalize().as_vec3(), 1.0);
    let magnitude: f64 = [1e-44, 1e-42, 1e-40, 1e-38, 1e-30, 1e-20, 1.0, 1e20, 1e30, 1e36][case % 10];
    let scale = [1e-37, 1e-27, 1e-19, 1e-10, 1.0, 1e10, 1e20, 1e37][case / 10 % 8];
    // Lengths are guaranteed between these.
    let size = (magnitude * scale).clamp(1e-59, 1e59);
    let place = turn * Affine3A::from_scale(Vec3::splat((size / magnitude).min(1e38) as f32));
    let middle = vector([0.0, 1e-3, 1.0, 3.0][case / 80 % 4] * size);
    let half = vector([0.0, size][case / 320 % 2]);
    Situation {
        place: WorldFromModel::new(place).expect("finite"),
        magnitude: magnitude as f32,
        segment: [middle - half, middle + half],
        radius: 0.0,
        corner_error: 0.0,
    }
}

fn corners_of(triangles: &[[Vec3; 3]; LANES]) -> CornerLanes {
    let row = |corner: usize, axis: usize| Lanes(triangles.map(|triangle| triangle[corner][axis]));
    std::array::from_fn(|corner| std::array::from_fn(|axis| row(corner, axis)))
}

fn distance_of(segment: Segment, triangle: &Triangle) -> f64 {
    if segment[0] == segment[1] {
        return closest_on_triangle(segment[0], triangle).squared.sqrt();
    }
    match common_segment(triangle, &[segment[0], segment[1], segment[1]]) {
        Some(_) => 0.0,
        None => closest_of_segment_and_triangle(segment, triangle).squared.sqrt(),
    }
}

/// The worst ratios of a key to that of the distance, for boxes around points and for triangles.
fn check(
    count: usize,
    situation: fn(&mut Pcg64Mcg, usize) -> Situation,
    mut tell: impl FnMut(usize, &Situation, [f64; 2]),
) {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    for case in 0..count {
        let situation = situation(&mut rng, case);
        let Situation {
            place,
            magnitude,
            segment,
            radius,
            corner_error,
        } = &situation;
        let body = PlacedBounds::new(place, DVec3::splat((*magnitude).into()));
        let cull = DistanceCull::new(*segment, *radius, &body, *corner_error);
        let mut vector = |reach: f32| {
            let reach = f64::from(reach);
            Vec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..=reach) as f32))
        };
        let triangles: [[Vec3; 3]; LANES] = std::array::from_fn(|lane| {
            let [a, b] = [vector(*magnitude), vector(*magnitude)];
            match lane {
                // A point, a segment, a sliver, a small triangle.
                0 => [a; 3],
                1 => [a, b, a],
                2 => [a, b, a.midpoint(b) + vector(1e-6 * magnitude)],
                3 => [a, a + vector(1e-4 * magnitude), a + vector(1e-4 * magnitude)],
                _ => [a, b, vector(*magnitude)],
            }
        });
        let mut boxes = BoxLanes::default();
        for (lane, [corner, ..]) in triangles.iter().enumerate() {
            boxes.set(lane, &Aabb::from_points([*corner]));
        }
        let rounded = triangles.map(|triangle| triangle.map(|corner| corner + vector(1.0).signum() * *corner_error));
        let [of_boxes, of_triangles] = keys(&cull, &boxes, &corners_of(&rounded));
        for (lane, triangle) in triangles.iter().enumerate() {
            let triangle = triangle.map(|corner| place.transform_point(corner));
            let to_corner = triangle[0].distance(closest_on_segment(triangle[0], *segment));
            let distances = [to_corner, distance_of(*segment, &triangle)].map(|distance| distance - radius);
            let found = [of_boxes[lane], of_triangles[lane]];
            for (key, distance) in found.into_iter().zip(distances) {
                let most = cull.key(distance);
                assert!(key <= most, "case {case}, lane {lane}: {key} {most} {distance}");
            }
            tell(
                lane,
                &situation,
                std::array::from_fn(|of| f64::from(found[of]) / f64::from(cull.key(distances[of]))),
            );
        }
    }
}

#[test]
fn no_box_and_no_triangle_is_farther_than_its_distance() {
    check(40_000, random, |_, _, _| {});
}

#[test]
fn bodies_of_any_size_have_bounds() {
    check(16_000, extreme, |_, _, _| {});
}

#[test]
fn points_have_sharp_bounds() {
    let (mut worst, mut count) = ([1.0_f64; 2], 0);
    check(4_000, random, |lane, situation, shares| {
        let from_body = situation.segment[0].distance(situation.place.translation()) / f64::from(situation.magnitude);
        let is_small = situation.place.translation().length() < 10.0 * f64::from(situation.magnitude);
        // Much farther away, `f64` distances are rounded by more.
        let is_between = (2.0..1e8).contains(&from_body);
        let is_exact = situation.corner_error == 0.0;
        let is_ordinary = situation.place.linear().determinant().abs() > 0.1 && is_small && is_between && is_exact;
        if situation.segment[0] == situation.segment[1] && is_ordinary && lane > 2 {
            worst = [0, 1].map(|of| worst[of].min(shares[of]));
            count += 1;
        }
    });
    // Those that are moved towards the body lose a little.
    assert!(count > 400 && worst[0] > 0.99 && worst[1] > 0.99, "{worst:?} {count}");
}

#[test]
fn boxes_of_infinite_size_have_no_distance() {
    let mut boxes = BoxLanes::default();
    boxes.set_all(&Aabb::UNBOUNDED);
    for magnitude in [DVec3::INFINITY, DVec3::ONE] {
        for place in [Affine3A::IDENTITY, Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))] {
            let body = PlacedBounds::new(&WorldFromModel::new(place).expect("finite"), magnitude);
            for half in [DVec3::ZERO, DVec3::Y] {
                let cull = DistanceCull::new([DVec3::ONE - half, DVec3::ONE + half], 0.0, &body, 0.0);
                for &level in levels() {
                    let within = with_simd!(level, simd => {
                        cull.lower_bounds(simd, &boxes, u8::MAX, cull.key(0.0), &mut Keys::default())
                    });
                    assert_eq!(within, u8::MAX, "{place:?} {magnitude} {half}");
                }
            }
        }
    }
}

#[test]
fn differences_that_overflow_have_no_bounds() {
    let corner = Vec3::splat(2e38);
    let body = PlacedBounds::new(&WorldFromModel::IDENTITY, corner.as_dvec3());
    let mut boxes = BoxLanes::default();
    boxes.set_all(&Aabb::from_points([corner]));
    for half in [DVec3::ZERO, DVec3::Y] {
        let (middle, corners) = (-corner.as_dvec3(), corners_of(&[[corner; 3]; LANES]));
        let cull = DistanceCull::new([middle - half, middle + half], 0.0, &body, 0.0);
        let most = cull.key(middle.distance(corner.as_dvec3()));
        let found = keys(&cull, &boxes, &corners);
        assert!(found.iter().flatten().all(|key| *key <= most), "{found:?} {most}");
    }
}
