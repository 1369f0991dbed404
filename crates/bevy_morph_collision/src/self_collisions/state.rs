//! What the plugin keeps for each mesh that is compared with itself.

use std::sync::Arc;

use bevy::prelude::*;
use morph_collision::{JointMatrices, MorphBvh, Pose, SelfQuery, TrianglePair, WorldFromModel};

use super::list::{MorphSelfCollisions, MorphSelfContact};
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
#[derive(Clone)]
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

/// What later runs depend on of a [`SelfState`] and its list.
#[derive(Clone)]
pub(crate) struct SelfMemory {
    regions: Vec<MorphSelfContact>,
    is_truncated: bool,
    /// These may be others, if the game has replaced the list.
    listed: Vec<u32>,
    answered_for: Option<AnsweredFor>,
    next_region: u32,
    points: Vec<Vec3>,
    world_from_model: WorldFromModel,
}

impl SelfState {
    pub(crate) fn memory(&self, list: &MorphSelfCollisions) -> SelfMemory {
        SelfMemory {
            regions: list.regions.clone(),
            is_truncated: list.is_truncated,
            listed: self.listed.clone(),
            answered_for: self.answered_for.clone(),
            next_region: self.next_region,
            points: self.points.clone(),
            world_from_model: self.world_from_model,
        }
    }

    /// Goes back to a state, or to that of a component that is new, without reporting anything.
    pub(crate) fn restore(&mut self, memory: Option<&SelfMemory>, list: &mut MorphSelfCollisions) {
        *self = Self::default();
        list.regions.clear();
        list.is_truncated = false;
        if let Some(memory) = memory {
            list.regions.clone_from(&memory.regions);
            list.is_truncated = memory.is_truncated;
            self.listed.clone_from(&memory.listed);
            self.answered_for.clone_from(&memory.answered_for);
            self.next_region = memory.next_region;
            self.points.clone_from(&memory.points);
            self.world_from_model = memory.world_from_model;
        }
    }

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
