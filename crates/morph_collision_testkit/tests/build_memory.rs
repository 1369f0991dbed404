//! The memory that a build takes: its peak, relative to the model and the tree that remain.

use std::sync::Arc;

use morph_collision::{BuildOptions, MorphBvh, MorphModel, SparseTarget};
use morph_collision_models::generated::{dolphin, random, rigs};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::moments::real_model;
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// The result of some work, the bytes that it leaves allocated, and the most that it had allocated at once.
fn measured<T>(work: impl FnOnce() -> T) -> (T, usize, usize) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let made = work();
    (made, MEMORY.current_usage() - before, MEMORY.peak_usage() - before)
}

/// Checks the peak while a model is made and its tree is built, without the caller's data.
fn check(mesh: &MorphMesh, about: &str, model: impl FnOnce() -> MorphModel) {
    let ((model, tree), remaining, peak) = measured(|| {
        let model = Arc::new(model());
        let tree = MorphBvh::build(model.clone(), &BuildOptions::default());
        (model, tree)
    });
    let (name, triangles, targets) = (&mesh.name, mesh.triangles.len(), mesh.targets.len());
    let ratio = peak as f64 / remaining as f64;
    println!(
        "{name}, {about}: {triangles} triangles, {targets} targets: {remaining} bytes, at most {ratio:.2} times as much"
    );
    assert!(ratio <= 3.0, "{name}, {about}: {peak} bytes for {remaining}");
    // Both count what they keep; the rest are the allocations of `Arc`s and the like.
    let counted = model.bytes() + tree.bytes();
    assert!(
        remaining.abs_diff(counted) < 8192,
        "{name}: {remaining} instead of {counted}"
    );
}

/// One test, because the allocator counts everything in the process.
#[test]
fn a_build_takes_at_most_three_times_what_remains() {
    let mut meshes = vec![
        dolphin(2),
        random::random_blob(1, 5, 30, 0.9),
        random::random_blob(1, 5, 30, 0.5),
        random::random_blob(1, 5, 30, 0.0),
        rigs::tube(1, 30, 16, 40),
        rigs::branching(2, 40, 8, 20),
    ];
    for name in ["mh_character.glb", "ict_face_skin.glb"] {
        if let Some(path) = real_model(name) {
            meshes.extend(read_meshes(&path).unwrap());
        }
    }
    for mesh in &meshes {
        check(mesh, "dense", || mesh.to_model().unwrap());
        if mesh.skin.is_none() && mesh.targets.iter().all(|target| !target.is_empty()) {
            let sparse = |target: &Vec<_>| target.iter().copied().collect();
            let targets: Vec<SparseTarget> = mesh.targets.iter().map(sparse).collect();
            check(mesh, "sparse", || {
                MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &targets).unwrap()
            });
        }
    }
}
