//! Tests of shapes against single triangles.

use std::sync::Arc;

use glam::{DVec2, DVec3, Quat, Vec3};
use morph_collision::{Body, BuildOptions, MorphBvh, MorphModel, PlacedShape, Pose, Shape, ShapeQuery, WorldFromModel};
use morph_collision_testkit::oracle;
use proptest::prelude::*;

use crate::signed_distance::{Twin, in_triangle};

fn unit_cube() -> PlacedShape {
    let half_extents = Vec3::ONE;
    PlacedShape::new(Shape::Cuboid { half_extents }, Quat::IDENTITY, Vec3::ZERO).unwrap()
}

#[test]
fn a_triangle_wholly_inside_intersects_and_one_around_does_not() {
    let inside = [DVec3::ZERO, DVec3::X * 0.5, DVec3::Y * 0.5];
    assert!(unit_cube().intersects(&inside));
    assert!(unit_cube().intersects(&[DVec3::splat(0.999); 3]));
    let beside = inside.map(|p| p + DVec3::Z * 1.5);
    assert!(!unit_cube().intersects(&beside));
}

#[test]
fn a_cuboid_is_touched_to_the_last_bit() {
    let tip = |x: f64| {
        [
            DVec3::new(x, 0.25, 0.5),
            DVec3::new(2.0, 1.0, 0.0),
            DVec3::new(2.0, -1.0, 0.5),
        ]
    };
    assert!(unit_cube().intersects(&tip(1.0)));
    assert!(!unit_cube().intersects(&tip(1.0_f64.next_up())));
    let edge_to_edge = |x: f64| {
        [
            DVec3::new(x, 0.0, 2.0 - x),
            DVec3::new(x, 0.5, 2.0 - x),
            DVec3::splat(3.0),
        ]
    };
    assert!(unit_cube().intersects(&edge_to_edge(1.0)));
    // Points that are on no face, but just inside or just outside.
    let point = |x: f64| [DVec3::new(x, 0.25, 0.5); 3];
    assert!(unit_cube().intersects(&point(1.0_f64.next_down())));
    assert!(!unit_cube().intersects(&point(1.0_f64.next_up())));
    assert!(!unit_cube().intersects(&edge_to_edge(1.0_f64.next_up())));
}

#[test]
fn a_flat_cuboid_is_no_more_than_its_rectangle() {
    let shape = Shape::Cuboid {
        half_extents: Vec3::new(1.0, 0.0, 1.0),
    };
    let plate = PlacedShape::new(shape, Quat::IDENTITY, Vec3::ZERO).unwrap();
    let coplanar = |x: f64| {
        [
            DVec3::new(x, 0.0, 0.0),
            DVec3::new(x + 1.0, 0.0, 0.0),
            DVec3::new(x, 0.0, 0.5),
        ]
    };
    assert!(plate.intersects(&coplanar(0.1)));
    assert!(plate.intersects(&coplanar(1.0)));
    assert!(!plate.intersects(&coplanar(1.0_f64.next_up())));
    assert!(!plate.intersects(&coplanar(1.5)));
}

/// Corners on a coarse grid, so that touching, flat and collapsed triangles are common.
fn grid_triangle() -> impl Strategy<Value = [DVec3; 3]> {
    prop::array::uniform3(prop::array::uniform3(-6_i8..7).prop_map(|p| DVec3::from_array(p.map(f64::from)) * 0.5))
}

fn grid_point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-4_i8..5).prop_map(|p| Vec3::from_array(p.map(f32::from)) * 0.5)
}

fn any_shape() -> impl Strategy<Value = Shape> {
    let size = || (0_i8..5).prop_map(|s| f32::from(s) * 0.5);
    prop_oneof![
        size().prop_map(|radius| Shape::Ball { radius }),
        (size(), size()).prop_map(|(half_length, radius)| Shape::Capsule { half_length, radius }),
        [size(), size(), size()].prop_map(|half| Shape::Cuboid {
            half_extents: Vec3::from_array(half)
        }),
        grid_point()
            .prop_filter("a direction", |normal| *normal != Vec3::ZERO)
            .prop_map(|normal| Shape::HalfSpace { normal }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn a_cuboid_agrees_with_the_oracle_on_a_grid(
        triangle in grid_triangle(),
        half in prop::array::uniform3(0_u8..4),
        center in grid_point(),
    ) {
        let half = Vec3::from_array(half.map(f32::from)) * 0.5;
        let placed = PlacedShape::new(
            Shape::Cuboid { half_extents: half },
            Quat::IDENTITY,
            center,
        ).unwrap();
        let (half, center) = (half.as_dvec3(), center.as_dvec3());
        let inside = triangle.iter().any(|p| (p - center).abs().cmple(half).all());
        // Each face as two triangles, split along the other diagonal.
        let mut truth = inside;
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for sign in [-1.0, 1.0] {
                let corner = |s: f64, t: f64| {
                    let mut p = DVec3::ZERO;
                    p[axis] = sign * half[axis];
                    p[u] = s * half[u];
                    p[v] = t * half[v];
                    center + p
                };
                let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
                truth |= oracle::triangles_intersect(&triangle, &[a, b, c]);
                truth |= oracle::triangles_intersect(&triangle, &[a, c, d]);
            }
        }
        prop_assert_eq!(placed.intersects(&triangle), truth);
    }

    #[test]
    fn a_capsule_without_radius_agrees_with_the_oracle_on_a_grid(
        triangle in grid_triangle(),
        center in grid_point(),
        half in 0_u8..5,
        turn in 0_usize..3,
    ) {
        // Rotates the axes, so that the segment runs along each.
        let turned = |p: DVec3| DVec3::new(p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]);
        let triangle = triangle.map(turned);
        let half_length = f32::from(half) * 0.5;
        let placed = PlacedShape::new(Shape::Capsule { half_length, radius: 0.0 }, Quat::IDENTITY, center).unwrap();
        let (center, half) = (center.as_dvec3(), DVec3::Y * f64::from(half_length));
        let (p, q) = (center - half, center + half);
        prop_assert_eq!(placed.intersects(&triangle), oracle::triangles_intersect(&triangle, &[p, p, q]));
    }

    #[test]
    fn an_oblique_segment_agrees_with_the_oracle(
        triangle in grid_triangle(),
        center in grid_point(),
        half in 0_u8..5,
        turn in prop::array::uniform3(-3.0_f32..3.0),
        through in 0_usize..4,
    ) {
        let rotation = Quat::from_scaled_axis(Vec3::from_array(turn));
        let half_length = f32::from(half) * 0.5;
        let placed = PlacedShape::new(Shape::Capsule { half_length, radius: 0.0 }, rotation, center).unwrap();
        // The same ends, bit for bit.
        let [x, y, z, w] = rotation.to_array().map(f64::from);
        let rotation = glam::DMat3::from_quat(glam::DQuat::from_xyzw(x, y, z, w).normalize());
        let [p, q] = [-1.0, 1.0].map(|side| rotation * (DVec3::Y * (side * f64::from(half_length))) + center.as_dvec3());
        let mut triangle = triangle;
        // In many cases a corner is an end of the segment.
        if through < 2 {
            triangle[0] = [p, q][through];
        }
        prop_assert_eq!(placed.intersects(&triangle), oracle::triangles_intersect(&triangle, &[p, p, q]));
    }

    #[test]
    fn the_signed_distance_of_a_point_agrees_with_its_twin(
        shape in any_shape(),
        turn in prop::array::uniform3(-3.0_f32..3.0),
        center in grid_point(),
        triangle in grid_triangle(),
        at in [0.0..1.0, 0.0..1.0],
    ) {
        let rotation = Quat::from_scaled_axis(Vec3::from_array(turn));
        let twin = Twin::new(shape, rotation, center);
        let point = in_triangle(&triangle, DVec2::from_array(at));
        prop_assert!((twin.placed.signed_distance(point) - twin.of_point(point)).abs() < 1e-13);
    }
}

#[test]
fn a_ball_centred_on_a_triangle_leaves_it_along_its_normal() {
    let corner = |x: f32, y: f32| DVec3::new(f64::from(x), f64::from(y), 0.0);
    let (mut seed, mut centred) = (1_u32, 0);
    let mut random = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 24) as f32
    };
    for _ in 0..2000 {
        // Corners around the centre, about a third of a turn apart.
        let center = [random() - 0.5, random() - 0.5];
        let mut triangle = [DVec3::ZERO; 3];
        for (i, p) in triangle.iter_mut().enumerate() {
            let (sin, cos) = (2.1 * i as f32 + random()).sin_cos();
            *p = corner(center[0] + cos * (0.5 + random()), center[1] + sin * (0.5 + random()));
        }
        let center = corner(center[0], center[1]);
        if !oracle::triangles_intersect(&triangle, &[center; 3]) {
            continue;
        }
        let place = center.as_vec3();
        let point = PlacedShape::new(Shape::Ball { radius: 0.0 }, Quat::IDENTITY, place).unwrap();
        assert!(point.intersects(&triangle), "{center} on {triangle:?}");
        assert!(PlacedShape::ball(center, 0.0).unwrap().intersects(&triangle));

        let corners = triangle.map(DVec3::as_vec3);
        let model = MorphModel::from_displacements::<[Vec3; 3]>(&corners, &[[0, 1, 2]], &[]).unwrap();
        let bvh = MorphBvh::build(Arc::new(model), &BuildOptions::default());
        let mut pose = Pose::new(Arc::new(bvh));
        let body = Body::new(&mut pose, &WorldFromModel::IDENTITY);
        let ball = PlacedShape::ball(center, 0.5).unwrap();
        let contact = ShapeQuery::new().closest(body, &ball, 0.0).unwrap().unwrap();
        assert_eq!(contact.distance, -0.5);
        assert!((contact.normal.z.abs() - 1.0).abs() < 1e-12, "{contact:?}");
        assert_eq!(contact.point_on_shape, center + contact.normal * 0.5, "{contact:?}");
        centred += 1;
    }
    assert!(centred > 500, "{centred}");
}
