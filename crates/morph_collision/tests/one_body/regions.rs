//! Boxes and frusta, checked against every triangle by the exact oracle.

use glam::{DVec3, Vec3};
use morph_collision::{Aabb, Body, ConvexRegion, Pose, ShapeQuery};

use crate::bodies::{self, Case, Random, box_around, snap};
use crate::reference::{Corners, touch};

fn assert_region(case: &Case, poses: &mut [Pose], region: &ConvexRegion, truth: &[u32], what: &str) {
    let world_from_model = case.world_from_model();
    for pose in poses {
        let mut found = Vec::new();
        let mut query = ShapeQuery::new();
        query.all_in_region(Body::new(pose, &world_from_model), region, &mut found);
        assert_eq!(found, truth, "{}: {what}", case.name);
        let meets = query.any_in_region(Body::new(pose, &world_from_model), region);
        assert_eq!(meets, !truth.is_empty());
    }
}

fn numbers(triangles: &[Corners], test: impl Fn(&Corners) -> bool) -> Vec<u32> {
    (0..triangles.len() as u32)
        .filter(|t| test(&triangles[*t as usize]))
        .collect()
}

/// A triangle meets a convex polyhedron if it meets the polyhedron's boundary or is inside.
fn meets_polyhedron(triangle: &Corners, faces: &[Corners], holds: impl Fn(DVec3) -> bool) -> bool {
    holds(triangle[0]) || faces.iter().any(|face| touch(triangle, face))
}

fn faces_of_box(min: DVec3, max: DVec3) -> Vec<Corners> {
    let corner = |i: usize| {
        let take = |axis: usize| if i >> axis & 1 == 1 { max[axis] } else { min[axis] };
        DVec3::new(take(0), take(1), take(2))
    };
    let quads = [
        [0, 1, 3, 2],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 3, 7, 5],
    ];
    quads
        .iter()
        .flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]].map(|t| t.map(corner)))
        .collect()
}

#[test]
fn boxes_meet_the_triangles_that_the_oracle_says() {
    let mut found = 0;
    for case in bodies::generated().into_iter().chain(bodies::real()) {
        let triangles = case.world_triangles();
        let bounds = box_around(&triangles);
        let mut poses = case.poses();
        let mut random = Random(23);
        for i in 0..10 {
            let triangle = triangles[random.below(triangles.len())];
            // Boxes with a corner at `center`, a flat one, a point, and an ordinary one.
            let center = if i % 2 == 0 {
                triangle[random.below(3)]
            } else {
                random.around(bounds)
            };
            let center = center.as_vec3();
            let size = (0.3 * (bounds.1 - bounds.0) * (random.point().abs())).as_vec3();
            let (min, max) = match i % 5 {
                0 => (center, center + size),
                1 => (center - size, center),
                2 => (center - size, center + size * Vec3::new(1.0, -1.0, 1.0)),
                3 => (center, center),
                _ => (center - size, center + size),
            };
            let bounds = Aabb {
                min: min.min(max),
                max: max.max(min),
            };
            let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
            let faces = faces_of_box(low, high);
            let holds = |p: DVec3| low.cmple(p).all() && p.cmple(high).all();
            let truth = numbers(&triangles, |t| meets_polyhedron(t, &faces, holds));
            found += truth.len();
            assert_region(
                &case,
                &mut poses,
                &ConvexRegion::from_aabb(&bounds).unwrap(),
                &truth,
                &format!("{bounds:?}"),
            );
        }
    }
    assert!(found > 500, "{found}");
}

/// A tetrahedron whose corners have few digits, so that the planes through them are exact in `f64`.
fn tetrahedron(random: &mut Random, bounds: (DVec3, DVec3)) -> Option<([DVec3; 4], ConvexRegion)> {
    let corners: [DVec3; 4] = std::array::from_fn(|_| snap(random.around(bounds), 1.0 / 64.0));
    let mut sides = Vec::new();
    for skipped in 0..4 {
        let [a, b, c] = [1, 2, 3].map(|i| corners[(skipped + i) % 4]);
        let normal = (b - a).cross(c - a);
        let inward = normal.dot(corners[skipped] - a).signum() * normal;
        if normal.dot(corners[skipped] - a) == 0.0 {
            return None;
        }
        sides.push((inward, -inward.dot(a)));
    }
    Some((corners, ConvexRegion::from_half_spaces(&sides).unwrap()))
}

#[test]
fn frusta_meet_the_triangles_that_the_oracle_says() {
    let mut found = 0;
    for case in bodies::generated() {
        let triangles = case.world_triangles();
        let bounds = box_around(&triangles);
        if bounds.1.abs().max_element() > 100.0 {
            continue; // the planes would not be exact
        }
        let mut poses = case.poses();
        let mut random = Random(29);
        for _ in 0..8 {
            let Some((corners, region)) = tetrahedron(&mut random, bounds) else {
                continue;
            };
            let faces: Vec<Corners> = (0..4).map(|i| [1, 2, 3].map(|j| corners[(i + j) % 4])).collect();
            // Barycentric coordinates decide whether a corner far from every face is inside; a corner near one meets a face.
            let holds = |p: DVec3| {
                let det = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
                let [a, b, c, d] = corners;
                let whole = det(a, b, c, d);
                [det(p, b, c, d), det(a, p, c, d), det(a, b, p, d), det(a, b, c, p)]
                    .iter()
                    .all(|part| part / whole > 1e-12)
            };
            let truth = numbers(&triangles, |t| meets_polyhedron(t, &faces, holds));
            found += truth.len();
            assert_region(&case, &mut poses, &region, &truth, &format!("{corners:?}"));
        }
    }
    assert!(found > 500, "{found}");
}

#[test]
fn all_of_space_holds_everything_and_contradictions_hold_nothing() {
    let case = &bodies::generated()[3];
    let mut poses = case.poses();
    let all: Vec<u32> = (0..case.mesh.triangles.len() as u32).collect();
    assert_region(
        case,
        &mut poses,
        &ConvexRegion::from_half_spaces(&[]).unwrap(),
        &all,
        "all of space",
    );
    let up = (DVec3::Z, -0.1);
    let down = (DVec3::NEG_Z, -0.1);
    assert_region(
        case,
        &mut poses,
        &ConvexRegion::from_half_spaces(&[up, down]).unwrap(),
        &[],
        "nothing",
    );
}

#[test]
fn half_spaces_that_share_only_a_plane_hold_what_touches_it() {
    let mesh = morph_collision_models::generated::degenerate::coplanar_sheets(3, 2);
    let count = mesh.triangles.len() as u32;
    let case = Case::new("sheets", mesh, vec![0.0], glam::Affine3A::IDENTITY);
    let mut poses = case.poses();
    let sides = [DVec3::Z, DVec3::NEG_Z].map(|normal| (normal, 0.0));
    let all: Vec<u32> = (0..count).collect();
    assert_region(
        &case,
        &mut poses,
        &ConvexRegion::from_half_spaces(&sides).unwrap(),
        &all,
        "the plane z = 0",
    );
}
