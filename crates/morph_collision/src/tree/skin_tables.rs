//! What the tree of a skinned mesh stores instead of the tables of [`Tables`](super::Tables).

use glam::Vec3;

use super::budget::Budget;
use super::chunks::Chunks;
use super::joint_boxes::JointBoxes;
use super::outer_tables::OuterTables;
use super::topology::Topology;
use crate::model::{MorphModel, Skin};

/// How the boxes of a skinned mesh's tree are bounded: fitted to posed vertices in chunks, and from one box per joint above them.
#[derive(Clone)]
pub(crate) struct SkinTables {
    pub(crate) chunks: Chunks,
    pub(crate) outer: OuterTables,
    pub(crate) joints: JointBoxes,
    /// The joint with the largest sum of weights, and a point in the middle of the vertices that it moves. `None` if no joint moves anything.
    pub(crate) middle: Option<(u16, Vec3)>,
}

impl SkinTables {
    pub(super) async fn new(model: &MorphModel, skin: &Skin, topology: &Topology, budget: &Budget) -> Self {
        let chunks = Chunks::new(topology, budget).await;
        let joints = JointBoxes::new(model, skin, topology, budget).await;
        Self {
            outer: OuterTables::new(model, skin, topology, &chunks, budget).await,
            middle: middle(model, skin, &joints),
            chunks,
            joints,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.chunks.bytes() + self.outer.bytes() + self.joints.bytes()
    }
}

/// Among joints with equal sums, the first one.
fn middle(model: &MorphModel, skin: &Skin, joints: &JointBoxes) -> Option<(u16, Vec3)> {
    let mut sums = vec![0.0; skin.joint_count()];
    for influence in (0..model.vertex_count() as u32).flat_map(|vertex| skin.influences(vertex)) {
        sums[usize::from(influence.joint)] += f64::from(influence.weight);
    }
    let sum = |joint: u16| sums[usize::from(joint)];
    joints
        .middles()
        .max_by(|(a, _), (b, _)| sum(*a).total_cmp(&sum(*b)).then(b.cmp(a)))
}
