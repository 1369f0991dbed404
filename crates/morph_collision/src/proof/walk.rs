//! The walk of one part of a proof: over pairs of nodes, and at leaves over pairs of triangles.

use super::branch::{Branches, Decision};
use super::outcome::{ProofOutcome, Witness};
use super::pair::{Pair, TriangleMotion};
use super::self_proof::SelfProof;
use crate::bounds::LANES;
use crate::query::TrianglePair;
use crate::tree::{ChildKind, Leaf, NodeId, PatchPair};

/// The run of one part.
pub(super) struct Walk<'a> {
    proof: &'a SelfProof,
    outcome: &'a mut ProofOutcome,
    most: u64,
    /// Parts of boxes that were looked at beyond the first of each pair.
    split_tests: u64,
    branches: Branches,
    pair: Pair,
    whole: Vec<[f32; 2]>,
    start: Vec<f32>,
    /// The open pairs of triangles of two leaves, for each pair of patches.
    masks: Vec<u64>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(proof: &'a SelfProof, outcome: &'a mut ProofOutcome) -> Self {
        Self {
            proof,
            outcome,
            most: proof.effort.steps / proof.parts().max(1) as u64,
            split_tests: 0,
            branches: Branches::default(),
            pair: Pair::default(),
            whole: Vec::new(),
            start: Vec::new(),
            masks: Vec::new(),
        }
    }

    /// Returns whether the steps were used up.
    pub(super) fn run(mut self, pair: [NodeId; 2]) -> bool {
        let proof = self.proof;
        let (mut stack, mut is_spent) = (vec![pair], false);
        while let Some([a, b]) = stack.pop() {
            let [of_a, of_b] = [a, b].map(|node| proof.nodes.get(node).triangles);
            if self.outcome.node_tests + self.outcome.box_tests >= self.most {
                self.outcome.undecided += if a == b { of_a * (of_a - 1) / 2 } else { of_a * of_b };
                is_spent = true;
                continue;
            }
            if a != b {
                self.outcome.node_tests += 1;
                if proof.nodes.are_apart(a, b, &proof.weights) {
                    self.outcome.free_by_nodes += of_a * of_b;
                    continue;
                }
            }
            if !proof.open([a, b], |below| stack.push(below))
                && let [ChildKind::Leaf(a), ChildKind::Leaf(b)] = [a, b].map(|node| proof.kind(node))
            {
                self.leaves(a, b);
            }
        }
        self.outcome.box_tests += self.split_tests;
        is_spent
    }

    fn leaves(&mut self, a: Leaf, b: Leaf) {
        let proof = self.proof;
        let motions = |leaf: Leaf| -> Vec<TriangleMotion> {
            let triangles = proof.bvh.topology.leaf_triangles(leaf).iter();
            triangles
                .map(|&triangle| TriangleMotion::new(proof.bvh.model(), triangle, &proof.weights))
                .collect()
        };
        let of_a = motions(a);
        let of_b = if a == b { of_a.clone() } else { motions(b) };
        let patches = of_b.len().div_ceil(LANES);
        self.masks.clear();
        self.masks.resize(of_a.len().div_ceil(LANES) * patches, 0);
        for (i, first) in of_a.iter().enumerate() {
            let from = if a == b { i + 1 } else { 0 };
            for (j, second) in of_b.iter().enumerate().skip(from) {
                if !first.shares_a_vertex(second) && !self.triangles(first, second) {
                    self.masks[i / LANES * patches + j / LANES] |= 1 << (i % LANES * LANES + j % LANES);
                }
            }
        }
        let open = &mut self.outcome.open.patches;
        let masks = self.masks.iter().enumerate().filter(|(_, mask)| **mask != 0);
        let masks = masks.take(proof.most_open.saturating_sub(open.len()));
        open.extend(masks.map(|(index, &unrelated)| PatchPair {
            leaves: [a.0 as u32, b.0 as u32],
            patches: [(index / patches) as u8, (index % patches) as u8],
            unrelated,
        }));
    }

    /// Returns whether two triangles are free.
    fn triangles(&mut self, a: &TriangleMotion, b: &TriangleMotion) -> bool {
        let proof = self.proof;
        self.pair.set(a, b);
        self.whole.clear();
        self.whole
            .extend(self.pair.targets.iter().map(|&target| proof.weights.of(target)));
        self.start.clear();
        self.start
            .extend(self.pair.targets.iter().map(|&target| proof.start[usize::from(target)]));
        // Every pair gets one box, even if the others are used up.
        let is_spent = self.split_tests >= self.most;
        let most = if is_spent { 1 } else { proof.effort.boxes_per_pair };
        let decision = self.branches.decide(&self.pair, &self.whole, &self.start, most);
        let outcome = &mut *self.outcome;
        let pair = || TrianglePair {
            triangle_a: a.triangle.min(b.triangle),
            triangle_b: a.triangle.max(b.triangle),
        };
        outcome.box_tests += 1;
        let is_free = matches!(decision, Decision::Free { .. });
        match decision {
            Decision::Free { boxes: 0 | 1 } => outcome.free_by_direction += 1,
            Decision::Free { boxes } => {
                self.split_tests += u64::from(boxes) - 1;
                outcome.free_by_splitting += 1;
            }
            Decision::Touching(weights) => {
                outcome.touching += 1;
                if outcome.witnesses.len() < proof.effort.listed {
                    let mut all = proof.start.clone();
                    for (&target, weight) in self.pair.targets.iter().zip(weights) {
                        all[usize::from(target)] = weight;
                    }
                    outcome.witnesses.push(Witness {
                        triangles: pair(),
                        weights: all,
                    });
                }
            }
            Decision::Undecided => {
                self.split_tests += u64::from(most.saturating_sub(1));
                outcome.undecided += 1;
                if outcome.undecided_pairs.len() < proof.effort.listed {
                    outcome.undecided_pairs.push(pair());
                }
            }
        }
        is_free
    }
}
