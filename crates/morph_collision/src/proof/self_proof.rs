use std::sync::Arc;

use super::nodes::{Node, NodeMotions};
use super::outcome::{Effort, ProofOutcome};
use super::walk::Walk;
use crate::InputError;
use crate::hash::hash;
use crate::model::WeightBox;
use crate::tree::{Area, ChildKind, Leaf, MorphBvh, OpenPairs, SelfCertificates};

/// A proof has at least this many parts, if the mesh is large enough.
const PARTS: usize = 256;

/// All parts together remember at most about this many pairs of patches that are open, which takes 100 MB. If a part has more than its share,
/// all of it counts as open.
const MAX_OPEN: usize = 1 << 22;

/// Proves which triangles of a mesh never touch for any weights in a box. Skinned meshes have no such proof.
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
    pub(super) bvh: Arc<MorphBvh>,
    pub(super) weights: WeightBox,
    /// Weights to try first.
    pub(super) start: Vec<f32>,
    pub(super) effort: Effort,
    pub(super) nodes: NodeMotions,
    parts: Vec<[Node; 2]>,
    /// How many pairs of patches that are open a part remembers.
    pub(super) most_open: usize,
    /// The same for all proofs about the same tree and box.
    key: u64,
}

impl SelfProof {
    /// Prepares a proof.
    ///
    /// # Errors
    /// [`InputError::WrongCount`] unless the box has one interval per target; [`InputError::SkinnedMesh`] if the mesh is skinned.
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
            return Err(InputError::SkinnedMesh {
                what: "a proof about weights".to_owned(),
                joints,
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
            let is_spent = Walk::new(self, &mut outcome).run(pair);
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
    /// let proof = SelfProof::new(&bvh, &WeightBox::new(&[0.0], &[0.9])?, Effort::light())?;
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
    pub(super) fn open(&self, [a, b]: [Node; 2], mut visit: impl FnMut([Node; 2])) -> bool {
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

    pub(super) fn kind(&self, node: Node) -> ChildKind {
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
        assert!(!answers[0].0.is_empty());
        assert!(answers.iter().all(|(pairs, _)| *pairs == answers[0].0));
        let (with, without) = (&answers[0].1, &answers[2].1);
        assert!(
            with.iter().zip(without).all(|(few, many)| few < many),
            "{with:?} {without:?}"
        );
    }
}
