//! What is measured at a size besides queries: memory, and the time to build trees.

use std::error::Error;
use std::sync::Arc;

use morph_collision::{Body, BuildOptions, MorphBvh, PairQuery, Pose, WorldFromModel};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::bench::{Experiment, Stopwatch, median};
use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use serde::{Deserialize, Serialize};

/// The memory of a mesh and of one of its bodies.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Bytes {
    pub(super) scene: String,
    pub(super) title: String,
    /// What grows in a series of scenes of the same name.
    pub(super) size: Option<usize>,
    pub(super) triangles: usize,
    pub(super) targets: usize,
    pub(super) model: usize,
    pub(super) tree: usize,
    pub(super) pose: usize,
    pub(super) measured: String,
}

/// Memory after a body was asked for all pairs in the middle of the experiment.
pub(super) fn bytes(experiment: &Experiment, measured: String) -> Result<Bytes, Box<dyn Error>> {
    let mesh = &experiment.mesh;
    let model = Arc::new(mesh.to_model()?);
    let pose = Pose::new(Arc::new(MorphBvh::build(model, &BuildOptions::default())));
    let mut poses = [pose.clone(), pose];
    let frame = &experiment.frames[experiment.frames.len() / 2];
    let mut places = [WorldFromModel::IDENTITY; 2];
    for ((pose, place), (weights, affine)) in poses.iter_mut().zip(&mut places).zip(frame) {
        pose.set_weights(weights)?;
        *place = WorldFromModel::new(*affine)?;
    }
    let ([a, b], [at_a, at_b]) = (&mut poses, &places);
    PairQuery::new().all(Body::new(a, at_a), Body::new(b, at_b), &mut Vec::new());
    Ok(Bytes {
        scene: experiment.name.clone(),
        title: experiment.title.clone(),
        size: None,
        triangles: mesh.triangles.len(),
        targets: mesh.targets.len(),
        model: poses[0].bvh().model().bytes(),
        tree: poses[0].bvh().bytes(),
        pose: poses[0].bytes(),
        measured,
    })
}

/// Seconds to build our tree and Parry's, medians over interleaved rounds.
pub(super) fn build_times(mesh: &MorphMesh, rounds: usize) -> Result<[f64; 2], Box<dyn Error>> {
    let model = Arc::new(mesh.to_model()?);
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..rounds {
        let clock = Stopwatch::start();
        let tree = MorphBvh::build(Arc::clone(&model), &BuildOptions::default());
        times[0].push(clock.elapsed().as_secs_f64());
        drop(tree);
        let clock = Stopwatch::start();
        let boxes: Vec<Aabb> = mesh.triangles.iter().map(|corners| around(mesh, corners)).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        times[1].push(clock.elapsed().as_secs_f64());
        drop(tree);
    }
    Ok(times.map(|times| median(times.into_iter())))
}

fn around(mesh: &MorphMesh, corners: &[u32; 3]) -> Aabb {
    let [p, q, r] = corners.map(|vertex| mesh.positions[vertex as usize]);
    Aabb {
        mins: p.min(q).min(r),
        maxs: p.max(q).max(r),
    }
}
