//! Proofs for all weights, compared with queries for many.
#![allow(clippy::disallowed_methods)]

mod certificates;
mod contradictions;
mod rounding;
mod verdicts;

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::Vec3;
use morph_collision::proof::{Effort, ProofOutcome, SelfProof, WeightBox};
use morph_collision::{BuildOptions, MorphBvh, MorphModel, Pose, SelfQuery, TrianglePair};
use morph_collision_models::mesh::MorphMesh;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Lists everything.
fn thorough(boxes_per_pair: u32) -> Effort {
    Effort {
        boxes_per_pair,
        listed: usize::MAX,
        ..Effort::default()
    }
}

fn tree(positions: &[Vec3], triangles: &[[u32; 3]], targets: &[Vec<Vec3>]) -> Arc<MorphBvh> {
    let model = MorphModel::from_displacements(positions, triangles, targets).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))
}

fn tree_of(mesh: &MorphMesh) -> Arc<MorphBvh> {
    Arc::new(MorphBvh::build(
        Arc::new(mesh.to_model().unwrap()),
        &BuildOptions::default(),
    ))
}

fn prove(bvh: &Arc<MorphBvh>, weights: &WeightBox, effort: Effort) -> ProofOutcome {
    SelfProof::new(bvh, weights, effort).unwrap().run()
}

/// Everything that is not proved free. The lists must be complete.
fn open_pairs(outcome: &ProofOutcome) -> BTreeSet<TrianglePair> {
    let witnesses = outcome.witnesses.iter().map(|witness| witness.triangles);
    let open: BTreeSet<_> = witnesses.chain(outcome.undecided_pairs.iter().copied()).collect();
    assert_eq!(
        open.len() as u64,
        outcome.touching + outcome.undecided,
        "each pair once"
    );
    open
}

fn touching(bvh: &Arc<MorphBvh>, weights: &[f32]) -> Vec<TrianglePair> {
    let mut pose = Pose::new(Arc::clone(bvh));
    pose.set_weights(weights).unwrap();
    let mut pairs = Vec::new();
    SelfQuery::new().all(&mut pose, &mut pairs);
    pairs
}

/// Weights in a box: anywhere, at corners, and near them.
fn draw(weights: &WeightBox, rng: &mut Pcg64Mcg) -> Vec<f32> {
    let share = rng.random_range(0.0..=1.0);
    let weight = |target| {
        let [low, high] = weights.interval(target).unwrap();
        match rng.random_range(0..4) {
            0 => high,
            1 => low,
            _ if rng.random_range(0.0..1.0) < share => rng.random_range(low..=high),
            _ => 0.0_f32.clamp(low, high),
        }
    };
    (0..weights.len()).map(weight).collect()
}
