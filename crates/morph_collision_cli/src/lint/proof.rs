//! What is proved for all weights from 0 to 1, beside the shapes that are tried.

use std::sync::Arc;

use morph_collision::proof::{Effort, ProofOutcome, SelfProof, WeightBox};
use morph_collision::{InputError, MorphBvh};
use morph_collision_models::text::Grouped;
use serde::Serialize;

use super::search::in_order;
use crate::messages::progress;

/// Pairs of triangles that share no vertex, by what is known of them for all weights from 0 to 1.
#[derive(Debug, Serialize)]
pub(super) struct ProofReport {
    pairs: u64,
    /// Free because nodes of the tree are apart.
    free_by_nodes: u64,
    /// Free along one direction.
    free_by_direction: u64,
    /// Free after splitting the box of weights.
    free_by_splitting: u64,
    /// Pairs that touch for some weights, at rest or not.
    touching: u64,
    undecided: u64,
    percent_free: f64,
}

impl ProofReport {
    pub(super) fn new(outcome: &ProofOutcome) -> Self {
        let pairs = outcome.pairs();
        Self {
            pairs,
            free_by_nodes: outcome.free_by_nodes,
            free_by_direction: outcome.free_by_direction,
            free_by_splitting: outcome.free_by_splitting,
            touching: outcome.touching,
            undecided: outcome.undecided,
            percent_free: match pairs {
                0 => 100.0,
                _ => outcome.free() as f64 / pairs as f64 * 100.0,
            },
        }
    }

    pub(super) fn sentence(&self) -> String {
        match self.pairs - self.touching - self.undecided {
            free if free == self.pairs => {
                "For all weights from 0 to 1, all pairs of triangles are proved free.".to_owned()
            }
            _ => format!(
                // Rounded down: it is not all.
                "For all weights from 0 to 1, {:.3} % of {} pairs of triangles are proved free, {} touch for some, and {} are undecided.",
                (self.percent_free * 1e3).floor() / 1e3,
                Grouped(self.pairs),
                Grouped(self.touching),
                Grouped(self.undecided)
            ),
        }
    }
}

/// Proves what it can on several threads.
pub(super) fn prove(tree: &Arc<MorphBvh>, threads: usize, effort: Effort) -> Result<ProofOutcome, InputError> {
    let weights = WeightBox::unit(tree.model().target_count());
    let proof = SelfProof::new(tree, &weights, effort)?;
    let steps = progress::count("part of the proof", proof.parts() as u64);
    let mut outcome = ProofOutcome::default();
    let run = |(): &mut (), part: usize| {
        let outcome = proof.run_part(part);
        steps.step();
        outcome
    };
    in_order(&mut vec![(); threads], proof.parts(), run, |_, part| {
        outcome.join(part);
        Ok(())
    })?;
    Ok(outcome)
}
