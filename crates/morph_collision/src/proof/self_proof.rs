//! A proof about one mesh, prepared and cut into parts.

use std::sync::Arc;

use super::nodes::NodeMotions;
use super::outcome::Effort;
use crate::hash::hash;
use crate::input_error::InputError;
use crate::model::WeightBox;
use crate::tree::{ChildKind, Leaf, MorphBvh, NodeId};

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
    pub(super) parts: Vec<[NodeId; 2]>,
    /// How many pairs of patches that are open a part remembers.
    pub(super) most_open: usize,
    /// The same for all proofs about the same tree and box.
    pub(super) key: u64,
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

    /// Cuts the pair of the root and itself into parts.
    fn cut(&self) -> Vec<[NodeId; 2]> {
        let mut parts = vec![[NodeId::ROOT; 2]];
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
    pub(super) fn open(&self, [a, b]: [NodeId; 2], mut visit: impl FnMut([NodeId; 2])) -> bool {
        let children = |node: NodeId| {
            let lanes = match self.kind(node) {
                ChildKind::Group(group) => Some((group, self.bvh.topology.group(group).children().len())),
                ChildKind::Leaf(_) => None,
            };
            lanes.map(|(group, lanes)| (0..lanes).map(move |lane| NodeId::new(group, lane)))
        };
        let (of_a, of_b) = (children(a), children(b));
        let size = |node: NodeId| self.nodes.get(node).triangles;
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

    pub(super) fn kind(&self, node: NodeId) -> ChildKind {
        node.child(&self.bvh.topology).kind()
    }
}

/// A hash of the mesh, the order of its triangles in the tree, and the box.
fn key(bvh: &MorphBvh, weights: &WeightBox) -> u64 {
    let topology = &bvh.topology;
    let triangles = (0..topology.triangle_count()).map(|index| u64::from(topology.triangle(index)));
    let leaves = (0..topology.leaf_count()).map(|leaf| topology.leaf_range(Leaf(leaf)).end as u64);
    let intervals = (0..weights.len()).filter_map(|target| weights.interval(target));
    let ends = intervals.flatten().map(|end| u64::from(end.to_bits()));
    let all = triangles.chain(leaves).chain(ends);
    hash(bvh.model().fingerprint(), all)
}
