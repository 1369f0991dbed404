//! Methods about the whole posed shape: bounds, positions and normals.

use glam::{DVec3, Vec3};
use morph_collision::{Aabb, WorldFromModel};
use morph_collision_testkit::oracle;

use crate::bodies::{self, box_around};

#[test]
fn tight_bounds_are_the_smallest_and_lie_in_the_conservative_ones() {
    for case in bodies::generated() {
        let world_from_model = case.world_from_model();
        let posed = oracle::posed_vertices(&case.mesh.positions, &case.mesh.targets, &case.weights);
        let used = case.mesh.triangles.iter().flatten().map(|v| posed[*v as usize]);
        let expected = Aabb::from_points(used);
        let (min, max) = box_around(&case.world_triangles());
        for pose in &mut case.poses() {
            assert_eq!(
                pose.tight_world_bounds(&WorldFromModel::IDENTITY),
                expected,
                "{}",
                case.name
            );
            let loose = pose.bounds();
            assert!(loose.contains(expected.min) && loose.contains(expected.max));
            let world = pose.tight_world_bounds(&world_from_model);
            assert!(world.min.as_dvec3().cmple(min).all() && world.max.as_dvec3().cmpge(max).all());
            for axis in 0..3 {
                assert!(f64::from(world.min[axis].next_up()) > min[axis], "{}", case.name);
                assert!(f64::from(world.max[axis].next_down()) < max[axis], "{}", case.name);
            }
            let loose = pose.world_bounds(&world_from_model);
            assert!(loose.contains(world.min) && loose.contains(world.max), "{}", case.name);
        }
    }
}

#[test]
fn positions_are_the_oracles() {
    for case in bodies::generated() {
        let expected = oracle::posed_vertices(&case.mesh.positions, &case.mesh.targets, &case.weights);
        for pose in &mut case.poses() {
            let mut positions = Vec::new();
            pose.source_positions(&mut positions);
            assert_eq!(positions, expected);
        }
    }
}

#[test]
fn normals_are_means_by_area_in_model_and_world_space() {
    for case in bodies::generated() {
        if case.name.contains("zero_area") || case.name.contains("all_equal") || case.name.contains("slivers") {
            continue; // no normals, or normals decided by rounding
        }
        let world_from_model = case.world_from_model();
        let world = case.world_triangles();
        // None of these meshes has two vertices at the same position, so nothing is welded.
        let mut sums = vec![DVec3::ZERO; case.mesh.positions.len()];
        for (corners, [a, b, c]) in case.mesh.triangles.iter().zip(&world) {
            for v in corners {
                sums[*v as usize] += (b - a).cross(c - a);
            }
        }
        let mut pose = case.poses().swap_remove(0);
        let mut normals = Vec::new();
        pose.source_normals(&mut normals);
        let model = case.mesh.to_model().unwrap();
        if model.vertex_count() < normals.len() {
            continue;
        }
        let largest = sums.iter().map(|sum| sum.length()).fold(0.0, f64::max);
        for (normal, sum) in normals.iter().zip(&sums) {
            if sum.length() > 1e-3 * largest && largest > 1e-9 {
                assert!((normal.length() - 1.0).abs() < 1e-6);
                let placed = world_from_model.transform_normal(normal.as_dvec3()).normalize();
                assert!(
                    (placed - sum.normalize()).length() < 1e-4,
                    "{}: {placed} {sum}",
                    case.name
                );
            }
        }
    }
}

#[test]
fn seams_share_one_normal() {
    let dolphin = morph_collision_models::generated::dolphin(0);
    let split = morph_collision_models::generated::degenerate::duplicated_vertices(&dolphin);
    let [mut whole, mut split_pose] = [&dolphin, &split].map(|mesh| {
        bodies::Case::new("dolphin", mesh.clone(), vec![0.5, 0.0], glam::Affine3A::IDENTITY)
            .poses()
            .swap_remove(0)
    });
    let (mut expected, mut normals) = (Vec::new(), Vec::new());
    whole.source_normals(&mut expected);
    split_pose.source_normals(&mut normals);
    for (corner, vertex) in dolphin.triangles.iter().flatten().enumerate() {
        assert!((normals[corner] - expected[*vertex as usize]).length() < 1e-6);
    }
}

#[test]
fn a_vertex_without_area_has_no_normal() {
    let mesh = morph_collision_models::generated::degenerate::all_equal(4);
    let case = bodies::Case::new("all equal", mesh, vec![1.0], glam::Affine3A::IDENTITY);
    let mut pose = case.poses().swap_remove(0);
    let mut normals = Vec::new();
    pose.source_normals(&mut normals);
    assert_eq!(normals, [Vec3::ZERO; 12]);
}
