//! What later runs depend on of a collider's state, to go back to it.

use bevy::ecs::entity::{EntityMapper, MapEntities};
use morph_collision::PoseSnapshot;

use super::collider_state::ColliderState;
use super::freshness::Freshness;
use super::held::{Held, HeldMemory};
use super::locked_pose::LockedPose;
use super::placement::Placement;
use super::previous::Previous;
use crate::import::TreeKey;

/// What later runs depend on of a [`ColliderState`]. Poses are kept without what is blended in them.
#[derive(Clone)]
pub(crate) struct ColliderMemory {
    tree: Option<TreeKey>,
    pose: Option<PoseSnapshot>,
    has_joints: bool,
    placed: Option<Placement>,
    held: Option<HeldMemory>,
    previous: Previous,
    freshness: Freshness,
}

impl ColliderState {
    pub(crate) fn memory(&self) -> ColliderMemory {
        ColliderMemory {
            tree: self.tree,
            pose: self.pose.as_ref().map(LockedPose::snapshot),
            has_joints: self.has_joints,
            placed: self.placed.clone(),
            held: self.held.as_deref().map(Held::memory),
            previous: self.previous.clone(),
            freshness: self.freshness,
        }
    }

    /// Goes back to a state, or to that of a collider that has not been read yet. What has been reported stays, and the next run looks at
    /// everything that the state was made of.
    pub(crate) fn restore(&mut self, memory: Option<&ColliderMemory>) {
        let Some(memory) = memory else {
            *self = Self {
                reported: self.reported,
                bad_weights: self.bad_weights,
                bad_placement: self.bad_placement,
                ..Self::default()
            };
            return;
        };
        self.tree = memory.tree;
        LockedPose::restore(&mut self.pose, memory.pose.as_ref());
        self.has_joints = memory.has_joints;
        self.placed.clone_from(&memory.placed);
        let held = self.held.take();
        self.held = (memory.held.as_ref()).map(|memory| Box::new(Held::restored(held, memory)));
        self.previous = memory.previous.clone();
        self.freshness = memory.freshness;
        self.freshness.look_again();
    }
}

impl MapEntities for ColliderMemory {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        let placements = self
            .placed
            .iter_mut()
            .chain(self.held.as_mut().map(|held| &mut held.placed));
        placements.for_each(|placed| placed.map_entities(mapper));
    }
}
