//! Shapes against single triangles.

use glam::{DVec2, DVec3, Quat, Vec3};
use morph_collision::{PlacedShape, Shape};
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
    // Points that are on no face, but a bit inside or outside.
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
        // Each face as the two rectangles' halves, cut along the other diagonal.
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
        half in 1_u8..5,
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
