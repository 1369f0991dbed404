//! What is measured at a size besides queries: memory, and the time to build trees.

use std::error::Error;
use std::sync::Arc;

use morph_collision::{Body, BuildOptions, MorphBvh, PairQuery, WorldFromModel};
use morph_collision_testkit::bench::{Experiment, Stopwatch, median};
use morph_collision_testkit::mesh::MorphMesh;
use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};

use crate::topics::bytes::{Bytes, at_rest};

/// Memory after a body was asked for all pairs in the middle of the experiment.
pub(super) fn bytes(experiment: &Experiment, measured: String) -> Result<Bytes, Box<dyn Error>> {
    let pose = at_rest(&experiment.mesh)?;
    let mut poses = [pose.clone(), pose];
    let frame = &experiment.frames[experiment.frames.len() / 2];
    let mut places = [WorldFromModel::IDENTITY; 2];
    for ((pose, place), (weights, affine)) in poses.iter_mut().zip(&mut places).zip(frame) {
        pose.set_weights(weights)?;
        *place = WorldFromModel::new(*affine)?;
    }
    let ([a, b], [at_a, at_b]) = (&mut poses, &places);
    PairQuery::new().all(Body::new(a, at_a), Body::new(b, at_b), &mut Vec::new());
    Bytes::of(experiment, &experiment.title, &poses[0], measured)
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
