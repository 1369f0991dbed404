//! A GPU's blend, fused or in another order, stays within the distance from ours that docs/numerics.md gives.

use std::path::Path;

use glam::Vec3;
use morph_collision_models::generated::random::random_blob;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::moments::real_model;
use morph_collision_testkit::oracle::posed_vertices;

/// Blends targets in a given order, with fused multiply-add.
fn fused<'a>(base: &[Vec3], terms: impl Iterator<Item = (f32, &'a Vec<Vec3>)>) -> Vec<Vec3> {
    let mut posed = base.to_vec();
    for (weight, target) in terms {
        for (vertex, displacement) in posed.iter_mut().zip(target) {
            *vertex = Vec3::from_array(std::array::from_fn(|axis| {
                weight.mul_add(displacement[axis], vertex[axis])
            }));
        }
    }
    posed
}

fn largest(points: &[Vec3]) -> f64 {
    f64::from(points.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max))
}

/// The largest difference of a coordinate in any other blend of a mesh, in units of twice the vertex bound, and of the mesh's
/// largest coordinate.
fn differences(mesh: &MorphMesh, weights: &[f32]) -> [f64; 2] {
    let ours = posed_vertices(&mesh.positions, &mesh.targets, weights);
    let active = || weights.iter().copied().zip(&mesh.targets).filter(|term| term.0 != 0.0);
    let backwards: Vec<_> = active().collect();
    let others = [
        fused(&mesh.positions, active()),
        fused(&mesh.positions, backwards.into_iter().rev()),
    ];
    let moved: f64 = active()
        .map(|(weight, target)| f64::from(weight.abs()) * largest(target))
        .sum();
    let reach = largest(&mesh.positions) + moved;
    let bound = 2.0 * (active().count() + 1) as f64 * f64::from(f32::EPSILON / 2.0) * reach * 1.01;
    let apart = |other: &Vec<Vec3>| {
        let each = ours
            .iter()
            .zip(other)
            .map(|(p, q)| (p.as_dvec3() - q.as_dvec3()).abs().max_element());
        each.fold(0.0, f64::max)
    };
    let apart = others.iter().map(apart).fold(0.0, f64::max);
    [apart / bound, apart / largest(&mesh.positions)]
}

#[test]
fn a_fused_or_reversed_blend_is_within_twice_the_vertex_bound() {
    let mut largest = 0.0_f64;
    for seed in 0..20 {
        let mesh = random_blob(seed, 2, 24, 0.2);
        let weights: Vec<f32> = (0..24).map(|k| ((seed * 31 + k * 7) as f32).sin() * 1.7).collect();
        let [of_bound, _] = differences(&mesh, &weights);
        assert!(of_bound <= 1.0, "seed {seed}: {of_bound}");
        largest = largest.max(of_bound);
    }
    assert!(largest > 0.01, "{largest}: the blends are hardly different");
}

#[test]
fn on_faces_the_difference_is_a_few_last_places() {
    let judge = |name: &str, mesh: &MorphMesh, shapes: &[Vec<f32>]| {
        let (mut of_bound, mut of_size) = (0.0_f64, 0.0_f64);
        for weights in shapes {
            let [bound, size] = differences(mesh, weights);
            (of_bound, of_size) = (of_bound.max(bound), of_size.max(size));
        }
        println!("{name}: {of_bound:.4} of the bound, {of_size:.1e} of the largest coordinate");
        assert!(of_bound <= 1.0 && of_size < 1e-6, "{name}: {of_bound}, {of_size}");
        assert!(of_size > 1e-8, "{name}: {of_size}: the blends are hardly different");
    };
    let most_targets = |path: &Path| {
        read_meshes(path)
            .unwrap()
            .into_iter()
            .max_by_key(|mesh| mesh.targets.len())
    };

    let path = real_model("mh_head_eyes_teeth_arkit52.glb").expect("the head is in assets/");
    let head = most_targets(&path).expect("it has a mesh");
    // About a third of the targets active, as in a captured frame.
    let shape = |frame: usize| -> Vec<f32> {
        let weight = |k: usize| ((frame * 17 + k * 7) as f32).sin();
        (0..head.targets.len())
            .map(|k| (1.5 * weight(k) - 0.75).max(0.0))
            .collect()
    };
    let shapes: Vec<Vec<f32>> = (0..18).map(shape).collect();
    judge("head", &head, &shapes);

    for name in ["mh_head_eyes_teeth_arkit52_dao.glb", "ict_face_skin.glb"] {
        let Some(path) = real_model(name) else { continue };
        let mesh = most_targets(&path).expect("it has a mesh");
        let captured: Vec<Vec<f32>> = mesh.animations[0].weights.iter().step_by(10).cloned().collect();
        assert!(!captured.is_empty());
        judge(name, &mesh, &captured);
    }
}
