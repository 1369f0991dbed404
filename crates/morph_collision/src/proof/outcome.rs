//! How hard a proof tries, and what it finds.

use crate::query::TrianglePair;
use crate::tree::OpenPairs;

/// How hard a proof tries before it leaves pairs undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// How many parts of the box of weights are looked at for each pair of triangles.
    pub boxes_per_pair: u32,
    /// How many pairs of nodes and of triangles are looked at in all. Each part of the proof gets an equal share, and may look at as many
    /// further parts of boxes; when these are used up, one is left for each pair.
    pub steps: u64,
    /// How many witnesses and how many undecided pairs each part of the proof lists. All are counted.
    pub listed: usize,
}

impl Effort {
    /// One box for each pair of triangles, and no lists. It proves nearly as much as the default, in a fraction of the time: for certificates.
    #[must_use]
    pub fn light() -> Self {
        Self {
            boxes_per_pair: 1,
            listed: 0,
            ..Self::default()
        }
    }
}

impl Default for Effort {
    fn default() -> Self {
        Self {
            boxes_per_pair: 32,
            steps: 1 << 28,
            listed: 1 << 12,
        }
    }
}

/// Two triangles that touch, and weights for which they do.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// The triangles, the smaller index first.
    pub triangles: TrianglePair,
    /// Weights of all targets, in the box.
    pub weights: Vec<f32>,
}

/// What is proved about the pairs of triangles that share no vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProofOutcome {
    /// Pairs that are free because nodes above them are.
    pub free_by_nodes: u64,
    /// Pairs that are free along one direction for all weights.
    pub free_by_direction: u64,
    /// Pairs that are free because the box of weights was split.
    pub free_by_splitting: u64,
    /// Pairs that touch for some weights in the box.
    pub touching: u64,
    /// Pairs that are neither proved free nor known to touch. If the steps were used up, pairs that share a vertex may be among them.
    pub undecided: u64,
    /// Witnesses of touching pairs, up to the limit.
    pub witnesses: Vec<Witness>,
    /// Undecided pairs, the smaller index first, up to the limit.
    pub undecided_pairs: Vec<TrianglePair>,
    /// Pairs of nodes that were compared.
    pub node_tests: u64,
    /// Parts of boxes that were looked at for pairs of triangles.
    pub box_tests: u64,
    /// Everything that is not proved free.
    pub(super) open: OpenPairs,
    /// The parts of the proof that were run.
    pub(super) parts: Vec<usize>,
    /// The key of the proof. `None` if nothing was run.
    pub(super) proof: Option<u64>,
    /// Whether parts of different proofs were joined.
    pub(super) is_mixed: bool,
}

impl ProofOutcome {
    /// The number of pairs that are proved free.
    #[must_use]
    pub fn free(&self) -> u64 {
        self.free_by_nodes + self.free_by_direction + self.free_by_splitting
    }

    /// The number of all pairs.
    #[must_use]
    pub fn pairs(&self) -> u64 {
        self.free() + self.touching + self.undecided
    }

    /// Whether every pair is proved free.
    #[must_use]
    pub fn is_free(&self) -> bool {
        self.touching == 0 && self.undecided == 0
    }

    /// Adds the outcome of another part of the same proof.
    pub fn join(&mut self, mut other: Self) {
        self.free_by_nodes += other.free_by_nodes;
        self.free_by_direction += other.free_by_direction;
        self.free_by_splitting += other.free_by_splitting;
        self.touching += other.touching;
        self.undecided += other.undecided;
        self.node_tests += other.node_tests;
        self.box_tests += other.box_tests;
        self.witnesses.append(&mut other.witnesses);
        self.undecided_pairs.append(&mut other.undecided_pairs);
        self.open.patches.append(&mut other.open.patches);
        self.open.areas.append(&mut other.open.areas);
        self.parts.append(&mut other.parts);
        self.is_mixed |= other.is_mixed || self.proof.is_some() && other.proof.is_some() && self.proof != other.proof;
        self.proof = self.proof.or(other.proof);
    }
}
