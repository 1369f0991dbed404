use std::sync::Arc;

use super::branch::{Branches, Decision};
use super::nodes::{Node, NodeMotions};
use super::outcome::{Effort, ProofOutcome, Witness};
use super::pair::{Pair, TriangleMotion};
use crate::InputError;
use crate::bounds::LANES;
use crate::hash::hash;
use crate::model::WeightBox;
use crate::query::TrianglePair;
use crate::tree::{Area, ChildKind, Leaf, MorphBvh, OpenPairs, PatchPair, SelfCertificates};

/// A proof has at least this many parts, if the mesh is large enough.
const PARTS: usize = 256;

/// All parts together remember at most about this many pairs of patches that are open, which takes 100 MB. If a part has more than its share,
/// all of it counts as open.
const MAX_OPEN: usize = 1 << 22;

/// Proves which triangles of a mesh touch for no weights in a box. Skinned meshes have no such proof.
///
/// The proof is about the posed vertices that every query sees, rounding included, so it cannot contradict a
/// [`SelfQuery`](crate::SelfQuery). Triangles that share a vertex are left out, as there.
///
/// Creating it takes memory for a box per node and target that moves it, about 56 bytes each, and an outcome lists what is not proved free, in up
/// to 100 MB. Parts are independent, so they can run on several threads.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvh, MorphModel};
/// use morph_collision::proof::{Effort, SelfProof, WeightBox};
///
/// // Two triangles, one above the other. The target lowers the upper one.
/// let base = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z + Vec3::X, Vec3::Z + Vec3::Y];
/// let lower = [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::NEG_Z, Vec3::NEG_Z, Vec3::NEG_Z];
/// let model = MorphModel::from_displacements(&base, &[[0, 1, 2], [3, 4, 5]], &[lower])?;
/// let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let careful = SelfProof::new(&bvh, &WeightBox::new(&[0.0], &[0.9])?, Effort::default())?;
/// assert!(careful.run().is_free());
/// let outcome = SelfProof::new(&bvh, &WeightBox::unit(1), Effort::default())?.run();
/// assert_eq!(outcome.witnesses[0].weights, [1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SelfProof {
    bvh: Arc<MorphBvh>,
    weights: WeightBox,
    /// Weights to try first.
    start: Vec<f32>,
    effort: Effort,
    nodes: NodeMotions,
    parts: Vec<[Node; 2]>,
    /// How many pairs of patches that are open a part remembers.
    most_open: usize,
    /// The same for all proofs about the same tree and box.
    key: u64,
}

impl SelfProof {
    /// Prepares a proof.
    ///
    /// # Errors
    /// The box has not one interval per target, or the mesh is skinned.
    pub fn new(bvh: &Arc<MorphBvh>, weights: &WeightBox, effort: Effort) -> Result<Self, InputError> {
        let model = bvh.model();
        if weights.len() != model.target_count() {
            return Err(InputError::WrongCount {
                what: "intervals of weights".to_owned(),
                given: weights.len(),
                expected: model.target_count(),
            });
        }
        if let Some(joints) = model.joint_count() {
            return Err(InputError::WrongCount {
                what: "joints of a mesh whose proof is about weights only".to_owned(),
                given: joints,
                expected: 0,
            });
        }
        let mut proof = Self {
            nodes: NodeMotions::new(model, &bvh.topology, weights),
            start: weights.closest_to_zero(),
            bvh: Arc::clone(bvh),
            weights: weights.clone(),
            effort,
            parts: Vec::new(),
            most_open: 0,
            key: key(bvh, weights),
        };
        proof.parts = proof.cut();
        proof.most_open = MAX_OPEN / proof.parts.len().max(1);
        Ok(proof)
    }

    /// The number of parts. They may be run in any order and on any threads.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.parts.len()
    }

    /// Runs one part; nothing if there is no such part.
    #[must_use]
    pub fn run_part(&self, part: usize) -> ProofOutcome {
        let mut outcome = ProofOutcome::default();
        if let Some(&pair) = self.parts.get(part) {
            outcome.parts.push(part);
            outcome.proof = Some(self.key);
            let most = self.effort.steps / self.parts.len() as u64;
            let walk = Walk {
                proof: self,
                outcome: &mut outcome,
                most,
                split_tests: 0,
                branches: Branches::default(),
                pair: Pair::default(),
                whole: Vec::new(),
                start: Vec::new(),
                masks: Vec::new(),
            };
            let is_spent = walk.run(pair);
            if is_spent || outcome.open.patches.len() >= self.most_open {
                outcome.open = OpenPairs {
                    patches: Vec::new(),
                    areas: vec![self.area(pair)],
                };
            }
        }
        outcome
    }

    /// Runs all parts, one after the other.
    #[must_use]
    pub fn run(&self) -> ProofOutcome {
        let mut outcome = ProofOutcome::default();
        for part in 0..self.parts() {
            outcome.join(self.run_part(part));
        }
        outcome
    }

    /// What queries may leave out while the weights are in the box of this proof. `outcome` is that of all parts.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use morph_collision::proof::{Effort, SelfProof, WeightBox};
    /// # use morph_collision::{BuildOptions, MorphBvh, MorphModel, Pose, SelfQuery};
    /// # use glam::Vec3;
    /// # let base = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z + Vec3::X, Vec3::Z + Vec3::Y];
    /// # let lower = [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::NEG_Z, Vec3::NEG_Z, Vec3::NEG_Z];
    /// # let model = MorphModel::from_displacements(&base, &[[0, 1, 2], [3, 4, 5]], &[lower])?;
    /// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
    /// // Once per mesh; `bvh.layout()` stores them.
    /// let proof = SelfProof::new(&bvh, &WeightBox::new(&[0.0], &[0.9])?, Effort::default())?;
    /// bvh.set_certificates(proof.certificates(&proof.run())?)?;
    /// // All triangles are proved apart, so there is nothing to do.
    /// let mut pose = Pose::new(bvh);
    /// let mut query = SelfQuery::new();
    /// pose.set_weights(&[0.8])?;
    /// assert!(!query.any(&mut pose));
    /// assert_eq!(query.stats().nodes_blended, 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A part is missing or was joined twice, or the outcome is of another tree or box.
    pub fn certificates(&self, outcome: &ProofOutcome) -> Result<SelfCertificates, InputError> {
        if outcome.is_mixed || outcome.proof.is_some_and(|proof| proof != self.key) {
            return Err(InputError::DifferentTrees {
                what: "a proof and all parts of its outcome".to_owned(),
            });
        }
        let mut parts = outcome.parts.clone();
        parts.sort_unstable();
        parts.dedup();
        if parts.len() != self.parts() || parts.len() != outcome.parts.len() {
            return Err(InputError::WrongCount {
                what: format!("parts of the proof ({} different ones)", parts.len()),
                given: outcome.parts.len(),
                expected: self.parts(),
            });
        }
        Ok(SelfCertificates::new(&self.bvh, self.weights.clone(), &outcome.open))
    }

    /// The leaves below two nodes.
    fn area(&self, nodes: [Node; 2]) -> Area {
        let topology = &self.bvh.topology;
        nodes.map(|node| {
            let child = topology.group(node.group as usize).child(usize::from(node.lane));
            topology.leaves_below(child).map(|leaf| leaf.0 as u32)
        })
    }

    /// Cuts the pair of the root and itself into parts.
    fn cut(&self) -> Vec<[Node; 2]> {
        let mut parts = vec![[Node { group: 0, lane: 0 }; 2]];
        loop {
            let mut finer = Vec::with_capacity(parts.len() * 4);
            for &pair in &parts {
                if !self.open(pair, |below| finer.push(below)) {
                    finer.push(pair);
                }
            }
            let is_done = finer.len() == parts.len() || finer.len() >= PARTS;
            parts = finer;
            if is_done {
                return parts;
            }
        }
    }

    /// Visits the pairs of nodes below a pair. Returns false if both are leaves.
    fn open(&self, [a, b]: [Node; 2], mut visit: impl FnMut([Node; 2])) -> bool {
        let children = |node: Node| {
            let lanes = match self.kind(node) {
                ChildKind::Group(group) => Some((group, self.bvh.topology.group(group).children().len())),
                ChildKind::Leaf(_) => None,
            };
            lanes.map(|(group, lanes)| {
                (0..lanes).map(move |lane| Node {
                    group: group as u32,
                    lane: lane as u8,
                })
            })
        };
        let (of_a, of_b) = (children(a), children(b));
        let size = |node: Node| self.nodes.get(node).triangles;
        match (of_a, of_b) {
            (None, None) => return false,
            (Some(of_a), Some(_)) if a == b => {
                for i in of_a.clone() {
                    for j in of_a.clone().filter(|j| j.lane >= i.lane) {
                        visit([i, j]);
                    }
                }
            }
            (Some(of_a), None) => of_a.for_each(|i| visit([i, b])),
            (Some(of_a), Some(_)) if size(a) >= size(b) => of_a.for_each(|i| visit([i, b])),
            (_, Some(of_b)) => of_b.for_each(|j| visit([a, j])),
        }
        true
    }

    fn kind(&self, node: Node) -> ChildKind {
        self.bvh
            .topology
            .group(node.group as usize)
            .child(usize::from(node.lane))
            .kind()
    }
}

/// A hash of the mesh, the order of its triangles in the tree, and the box.
fn key(bvh: &MorphBvh, weights: &WeightBox) -> u64 {
    let topology = &bvh.topology;
    let triangles = (0..topology.triangle_count()).map(|place| u64::from(topology.triangle(place)));
    let leaves = (0..topology.leaf_count()).map(|leaf| topology.leaf_range(Leaf(leaf)).end as u64);
    let intervals = (0..weights.len()).filter_map(|target| weights.interval(target));
    let ends = intervals.flatten().map(|end| u64::from(end.to_bits()));
    let all = triangles.chain(leaves).chain(ends);
    hash(bvh.model().fingerprint(), all)
}

/// The run of one part.
struct Walk<'a> {
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

impl Walk<'_> {
    /// Returns whether the steps were used up.
    fn run(mut self, pair: [Node; 2]) -> bool {
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
        open.extend(masks.map(|(place, &unrelated)| PatchPair {
            leaves: [a.0 as u32, b.0 as u32],
            patches: [(place / patches) as u8, (place % patches) as u8],
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
                        pair: pair(),
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

#[cfg(test)]
mod tests {
    use morph_collision_testkit::models::random::random_blob;

    use super::*;
    use crate::model::MorphModel;
    use crate::pose::Pose;
    use crate::query::SelfQuery;
    use crate::tree::BuildOptions;

    #[test]
    fn a_part_with_too_much_that_is_open_counts_as_open() {
        let blob = random_blob(7, 3, 3, 0.9);
        let model = MorphModel::from_displacements(&blob.positions, &blob.triangles, &blob.targets).unwrap();
        let model = Arc::new(model);
        let mut answers = Vec::new();
        for most_open in [usize::MAX, 4, 0] {
            let bvh = Arc::new(MorphBvh::build(model.clone(), &BuildOptions::default()));
            let mut proof = SelfProof::new(&bvh, &WeightBox::unit(3), Effort::default()).unwrap();
            proof.most_open = most_open;
            let outcome = proof.run();
            let has_areas = !outcome.open.areas.is_empty();
            assert_eq!(has_areas, most_open < usize::MAX);
            bvh.set_certificates(proof.certificates(&outcome).unwrap()).unwrap();
            let (mut pose, mut query, mut pairs) = (Pose::new(bvh), SelfQuery::new(), Vec::new());
            let mut work = Vec::new();
            for weights in [[0.1, 0.9, 0.5], [1.0, 1.0, 1.0], [0.7, 0.0, 0.8]] {
                pose.set_weights(&weights).unwrap();
                query.all(&mut pose, &mut pairs);
                work.push(query.stats().triangle_tests);
            }
            answers.push((pairs, work));
        }
        let [all, some, none] = &answers[..] else {
            unreachable!()
        };
        assert!(!all.0.is_empty() && all.0 == some.0 && all.0 == none.0);
        assert!(
            all.1.iter().zip(&none.1).all(|(few, many)| few < many),
            "{:?} {:?}",
            all.1,
            none.1
        );
    }
}
