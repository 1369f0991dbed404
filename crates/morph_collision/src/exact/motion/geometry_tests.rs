//! Points, normals and velocities of contacts with known geometry, and of random ones.

use glam::DVec3;
use proptest::prelude::*;

use super::geometry::ImpactGeometry;
use super::touch::{edge_edge, vertex_face};
use super::*;

type Line = [f64; 6];

fn moving([x, y, z, u, v, w]: Line) -> MovingPoint {
    MovingPoint::new(DVec3::new(x, y, z), DVec3::new(u, v, w))
}

fn resting([x, y, z]: [f64; 3]) -> MovingPoint {
    MovingPoint::resting(DVec3::new(x, y, z))
}

fn vector([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(x, y, z)
}

fn flat_face() -> [MovingPoint; 3] {
    [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(resting)
}

/// The geometry of two features that touch.
fn of(pair: &FeaturePair, outward: DVec3) -> ImpactGeometry {
    let time = pair.impact(1e-9, &mut StageCounts::default()).expect("they touch");
    impact_geometry(pair, time, outward)
}

fn assert_near(found: DVec3, expected: [f64; 3]) {
    assert!(found.distance(vector(expected)) < 1e-8, "{found}, not {expected:?}");
}

#[test]
fn a_vertex_meets_a_face_on_the_side_that_it_comes_from() {
    for (from, to, normal) in [(1.0, -3.0, 1.0), (-1.0, 3.0, -1.0)] {
        let vertex = moving([1.0, 0.5, from, 1.0, 0.5, to]);
        // Whatever the winding says.
        for outward in [DVec3::Z, DVec3::NEG_Z, DVec3::ZERO] {
            let found = of(&vertex_face(vertex, flat_face()), outward);
            assert_near(found.point, [1.0, 0.5, 0.0]);
            assert_near(found.normal, [0.0, 0.0, normal]);
            assert_near(found.velocity, [0.0, 0.0, to - from]);
            assert_eq!(found.barycentrics[0], [1.0, 0.0, 0.0]);
            assert_near(DVec3::from_array(found.barycentrics[1]), [0.625, 0.25, 0.125]);
        }
    }
}

#[test]
fn velocities_are_relative_at_the_point() {
    // The face turns about its edge on the y axis, through the resting vertex, and everything moves along x by 100.
    let train = 100.0;
    let face = [
        [0.0, 0.0, -1.0, train, 0.0, -1.0],
        [4.0, 0.0, -1.0, 4.0 + train, 0.0, 7.0],
        [0.0, 4.0, -1.0, train, 4.0, -1.0],
    ];
    let vertex = moving([2.0, 1.0, 0.0, 2.0 + train, 1.0, 0.0]);
    let found = of(&vertex_face(vertex, face.map(moving)), DVec3::ZERO);
    // Contact is at t = 1/4, where the face's plane is z = -1 + x / 2.
    assert_near(found.point, [2.0 + train / 4.0, 1.0, 0.0]);
    assert_near(found.velocity, [0.0, 0.0, -4.0]);
    assert_near(found.normal, [-(0.2_f64.sqrt()), 0.0, 0.8_f64.sqrt()]);
    assert_near(DVec3::from_array(found.barycentrics[1]), [0.25, 0.5, 0.25]);
}

#[test]
fn edges_meet_at_their_parameters_with_a_normal_across_both() {
    let x_axis = [[-1.0, 0.0, 0.0], [3.0, 0.0, 0.0]].map(resting);
    let falling = [[1.0, -2.0, 1.0, 1.0, -2.0, -1.0], [1.0, 6.0, 1.0, 1.0, 6.0, -1.0]].map(moving);
    let found = of(&edge_edge(x_axis, falling), DVec3::ZERO);
    assert_near(found.point, [1.0, 0.0, 0.0]);
    // The second edge comes from above, so the first is below.
    assert_near(found.normal, [0.0, 0.0, -1.0]);
    assert_near(found.velocity, [0.0, 0.0, 2.0]);
    assert_eq!(found.barycentrics, [[0.5, 0.5, 0.0], [0.75, 0.25, 0.0]]);
    let swapped = of(&edge_edge(falling, x_axis), DVec3::ZERO);
    assert_eq!(
        (swapped.point, swapped.normal, swapped.velocity),
        (found.point, -found.normal, -found.velocity)
    );
}

#[test]
fn at_the_start_and_along_a_plane_the_outside_decides() {
    // The vertex leaves a face that it touches, upwards or downwards; or it slides over it.
    for end in [[1.0, 1.0, 5.0], [1.0, 1.0, -5.0], [2.0, 1.0, 0.0]] {
        let vertex = MovingPoint::new(vector([1.0, 1.0, 0.0]), vector(end));
        for outward in [DVec3::Z, DVec3::NEG_Z] {
            assert_eq!(of(&vertex_face(vertex, flat_face()), outward).normal, outward);
        }
    }
    // It enters through the edge of a face in its plane.
    let sideways = moving([-1.0, 1.0, 0.0, 7.0, 1.0, 0.0]);
    for outward in [DVec3::Z, DVec3::NEG_Z] {
        let found = of(&vertex_face(sideways, flat_face()), outward);
        assert_near(found.point, [0.0, 1.0, 0.0]);
        assert_eq!(found.normal, outward);
    }
    // Without an outside, it is against the motion.
    let leaving = moving([1.0, 1.0, 0.0, 1.0, 1.0, 5.0]);
    assert_eq!(of(&vertex_face(leaving, flat_face()), DVec3::ZERO).normal, DVec3::NEG_Z);
}

#[test]
fn features_without_a_plane_have_the_direction_of_the_approach() {
    // Parallel edges, the upper one moves down and sideways.
    let lower = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]].map(resting);
    let upper = [[0.0, 0.0, 2.0, 1.0, 0.0, -2.0], [2.0, 0.0, 2.0, 3.0, 0.0, -2.0]].map(moving);
    let found = of(&edge_edge(upper, lower), DVec3::ZERO);
    assert_near(found.normal, [0.0, 0.0, 1.0]);
    assert_eq!(found.point.z, 0.0);
    // A face that is a segment.
    let segment = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 0.0, 0.0]].map(resting);
    let found = of(
        &vertex_face(moving([3.0, -1.0, -1.0, 3.0, 1.0, 1.0]), segment),
        DVec3::X,
    );
    assert_near(found.point, [3.0, 0.0, 0.0]);
    assert_near(found.normal, [0.0, -(0.5_f64.sqrt()), -(0.5_f64.sqrt())]);
    // Points, and motion along an edge.
    let point = [resting([0.0, 0.0, 0.0]); 3];
    let found = of(
        &vertex_face(moving([-1.0, -1.0, -1.0, 3.0, 3.0, 3.0]), point),
        DVec3::ZERO,
    );
    assert_near(found.normal, [-(1.0_f64 / 3.0).sqrt(); 3]);
    let behind = [[6.0, 0.0, 0.0, -2.0, 0.0, 0.0], [8.0, 0.0, 0.0, 0.0, 0.0, 0.0]].map(moving);
    assert_eq!(of(&edge_edge(behind, lower), DVec3::ZERO).normal, DVec3::X);
    // At rest.
    let two_points = edge_edge([resting([1.0, 0.0, 0.0]); 2], lower);
    assert_eq!(of(&two_points, DVec3::Y).normal, DVec3::Y);
    assert_eq!(of(&two_points, DVec3::ZERO).normal, DVec3::ZERO);
}

#[test]
fn nearly_parallel_edges_meet_in_one_point() {
    for power in [4, 8, 12, 16, 20] {
        let slope = 2.0_f64.powi(-2 * power);
        let lower = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]].map(resting);
        let upper = [
            [-1.0, -slope, 1.0, -1.0, -slope, -1.0],
            [1.0, 2.0 * slope, 1.0, 1.0, 2.0 * slope, -1.0],
        ];
        let found = of(&edge_edge(lower, upper.map(moving)), DVec3::ZERO);
        assert_near(found.point, [-1.0 / 3.0, 0.0, 0.0]);
        assert_near(found.normal, [0.0, 0.0, -1.0]);
    }
}

fn corners() -> impl Strategy<Value = [MovingPoint; 4]> {
    let coordinate = prop_oneof![-1.0..1.0_f64, (-2_i32..3).prop_map(f64::from)];
    prop::array::uniform24(coordinate).prop_map(|c| {
        std::array::from_fn(|i| {
            let line: Line = std::array::from_fn(|j| c[6 * i + j]);
            moving(line)
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn scale_changes_lengths_and_nothing_else(corners in corners(), is_face: bool, power in -40_i32..40) {
        let [a, b, c, d] = corners;
        let pair = if is_face { vertex_face(a, [b, c, d]) } else { edge_edge([a, b], [c, d]) };
        let Some(time) = pair.impact(1e-9, &mut StageCounts::default()) else { return Ok(()) };
        let found = impact_geometry(&pair, time, DVec3::Z);
        let scale = 2.0_f64.powi(power);
        let mut scaled = pair;
        for corner in &mut scaled.corners {
            *corner = MovingPoint::new(corner.start * scale, corner.end * scale);
        }
        let expected = ImpactGeometry { point: found.point * scale, velocity: found.velocity * scale, ..found };
        prop_assert_eq!(impact_geometry(&scaled, time, DVec3::Z), expected);
    }
}
