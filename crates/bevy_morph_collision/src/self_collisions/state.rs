//! What the plugin keeps for each mesh that is compared with itself.

use std::sync::Arc;

use bevy::prelude::*;
use morph_collision::{JointMatrices, MorphBvh, Pose, SelfQuery, TrianglePair, WorldFromModel};

use super::list::MorphSelfCollisions;
use super::regions::Changes;

/// The plugin's state for one [`MorphSelfCollisions`].
#[derive(Component, Default)]
pub(crate) struct SelfState {
    /// The regions that the list had after the last run. The game may have replaced the list since.
    pub(super) listed: Vec<u32>,
    pub(super) query: SelfQuery,
    pub(super) pairs: Vec<TrianglePair>,
    /// What the regions are the answer to. `None` if the collider takes no part.
    pub(super) answered_for: Option<AnsweredFor>,
    pub(super) next_region: u32,
    pub(super) changes: Changes,
    /// The points of the regions in the space of the pose, and where that is in the world.
    pub(super) points: Vec<Vec3>,
    pub(super) world_from_model: WorldFromModel,
}

/// Everything that an answer depends on.
pub(super) struct AnsweredFor {
    pub(super) tree: Arc<MorphBvh>,
    pub(super) weights: Vec<f32>,
    pub(super) joints: Option<JointMatrices>,
    pub(super) include_rest: bool,
    pub(super) limit: usize,
}

impl AnsweredFor {
    pub(super) fn new(pose: &Pose, include_rest: bool, limit: usize) -> Self {
        Self {
            tree: pose.bvh().clone(),
            weights: pose.weights().to_vec(),
            joints: pose.joints().cloned(),
            include_rest,
            limit,
        }
    }

    pub(super) fn is_about(&self, pose: &Pose, include_rest: bool, limit: usize) -> bool {
        Arc::ptr_eq(&self.tree, pose.bvh())
            && self.weights == pose.weights()
            && self.joints.as_ref() == pose.joints()
            && (self.include_rest, self.limit) == (include_rest, limit)
    }
}

impl SelfState {
    /// Ends all regions.
    pub(super) fn reset(&mut self, list: &mut MorphSelfCollisions) {
        self.changes.ended.append(&mut self.listed);
        self.answered_for = None;
        list.regions.clear();
        list.is_truncated = false;
    }

    pub(super) fn is_of(&self, list: &MorphSelfCollisions) -> bool {
        self.listed.iter().eq(list.regions.iter().map(|region| &region.region))
    }
}
