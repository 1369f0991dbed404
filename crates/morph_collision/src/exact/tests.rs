use glam::DVec3;
use proptest::prelude::*;

use super::{Triangle, triangles_intersect};

const fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

const FLAT: Triangle = [v(0.0, 0.0, 0.0), v(4.0, 0.0, 0.0), v(0.0, 4.0, 0.0)];

#[test]
fn crossing_touching_and_apart() {
    let through = [v(1.0, 1.0, -1.0), v(1.0, 1.0, 1.0), v(2.0, 1.0, 1.0)];
    assert!(triangles_intersect(&FLAT, &through));
    let tip_on_face = [v(1.0, 1.0, 0.0), v(1.0, 1.0, 1.0), v(2.0, 1.0, 1.0)];
    assert!(triangles_intersect(&FLAT, &tip_on_face));
    let tip_above = tip_on_face.map(|p| p + v(0.0, 0.0, f64::MIN_POSITIVE));
    assert!(!triangles_intersect(&FLAT, &tip_above));
    let shared_vertex = [v(0.0, 0.0, 0.0), v(-1.0, 0.0, 1.0), v(0.0, -1.0, 1.0)];
    assert!(triangles_intersect(&FLAT, &shared_vertex));
    let edge_on_edge = [v(1.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(1.0, -1.0, 3.0)];
    assert!(triangles_intersect(&FLAT, &edge_on_edge));
    let beside = [v(3.0, 3.0, -1.0), v(3.0, 3.0, 1.0), v(4.0, 3.0, 1.0)];
    assert!(!triangles_intersect(&FLAT, &beside));
}

#[test]
fn coplanar_triangles() {
    let inside = [v(0.5, 0.5, 0.0), v(1.0, 0.5, 0.0), v(0.5, 1.0, 0.0)];
    assert!(triangles_intersect(&FLAT, &inside));
    let across = [v(-1.0, 1.0, 0.0), v(5.0, 1.0, 0.0), v(5.0, 1.5, 0.0)];
    assert!(triangles_intersect(&FLAT, &across));
    let touching_side = [v(2.0, 2.0, 0.0), v(4.0, 4.0, 0.0), v(4.0, 3.0, 0.0)];
    assert!(triangles_intersect(&FLAT, &touching_side));
    let apart = touching_side.map(|p| p + v(1e-12, 0.0, 0.0));
    assert!(!triangles_intersect(&FLAT, &apart));
}

#[test]
fn triangles_degenerate_to_segments_and_points() {
    let segment = [v(1.0, 1.0, -1.0), v(1.0, 1.0, 0.0), v(1.0, 1.0, 1.0)];
    assert!(triangles_intersect(&FLAT, &segment));
    assert!(!triangles_intersect(&FLAT, &segment.map(|p| p + v(3.0, 0.0, 0.0))));
    let point = [v(2.0, 2.0, 0.0); 3];
    assert!(triangles_intersect(&FLAT, &point));
    assert!(triangles_intersect(&point, &point));
    assert!(!triangles_intersect(&point, &[v(2.0, 2.0, 1e-300); 3]));
    assert!(triangles_intersect(&segment, &[v(1.0, 1.0, 0.5); 3]));
    assert!(!triangles_intersect(&segment, &[v(1.0, 1.0, 1.5); 3]));
    let crossing = [v(0.0, 1.0, 0.0), v(2.0, 1.0, 0.0), v(0.5, 1.0, 0.0)];
    assert!(triangles_intersect(&segment, &crossing));
    let collinear_gap = segment.map(|p| p + v(0.0, 0.0, 2.5));
    assert!(!triangles_intersect(&segment, &collinear_gap));
    assert!(triangles_intersect(&segment, &segment.map(|p| p + v(0.0, 0.0, 2.0))));
}

/// Corners on a coarse grid, so that coplanar, touching and degenerate pairs are common.
fn grid_triangles() -> impl Strategy<Value = Triangle> {
    prop::array::uniform3(prop::array::uniform3(-2_i8..3).prop_map(|c| DVec3::from_array(c.map(f64::from))))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_order_of_triangles_and_corners_does_not_matter(a in grid_triangles(), b in grid_triangles()) {
        let expected = triangles_intersect(&a, &b);
        prop_assert_eq!(triangles_intersect(&b, &a), expected);
        prop_assert_eq!(triangles_intersect(&[a[1], a[2], a[0]], &b), expected);
        prop_assert_eq!(triangles_intersect(&a, &[b[1], b[0], b[2]]), expected);
    }

    #[test]
    fn it_agrees_with_the_oracle(a in grid_triangles(), b in grid_triangles()) {
        let truth = morph_collision_testkit::oracle::triangles_intersect(&a, &b);
        prop_assert_eq!(triangles_intersect(&a, &b), truth);
    }
}
