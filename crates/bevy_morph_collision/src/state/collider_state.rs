//! What the plugin keeps for each collider.

use super::bad_weights::BadWeights;
use super::held::Held;
use super::locked_pose::LockedPose;
use super::placement::Placement;
use super::previous::Before;
use super::readiness::Readiness;
use crate::components::MorphCollider;
use crate::import::TreeKey;
use bevy::prelude::*;
use morph_collision::Pose;

/// The plugin's state for one collider.
#[derive(Component, Default)]
pub(crate) struct ColliderState {
    /// The tree that the collider has or waits for.
    pub(crate) tree: Option<TreeKey>,
    /// The collider's instance of that tree; `None` until there is a tree.
    pub(crate) pose: Option<LockedPose>,
    /// Whether the pose is skinned and has joint matrices. A skinned pose without joint matrices takes no part.
    pub(crate) has_joints: bool,
    /// How the collider took part in the last run; `None` if it did not.
    pub(crate) placed: Option<Placement>,
    /// The state that collisions see if the collider has a tolerance. It can be older than the current one.
    pub(crate) held: Option<Box<Held>>,
    /// The collider's state one run earlier.
    pub(crate) before: Before,
    /// Whether the pose was replaced, or got other weights or joints, since its bounds were last requested.
    pub(crate) reposed: bool,
    /// Whether anything that affects an answer differs from the last run. With a tolerance: whether the state that collisions see
    /// has changed.
    pub(crate) changed: bool,
    /// The last run in which the collider was read. Disabled entities are not read.
    pub(crate) seen: u32,
    /// Which problem with its weights has been logged, so that it is not logged every frame.
    pub(crate) bad_weights: BadWeights,
    /// The same for its position and size.
    pub(crate) bad_place: bool,
    /// Which readiness event the collider got last.
    pub(crate) reported: Readiness,
}

impl ColliderState {
    pub(crate) fn pose_mut(&mut self) -> Option<&mut Pose> {
        self.pose.as_mut().map(LockedPose::get_mut)
    }
}

/// Removes the plugin's state together with [`MorphCollider`].
pub(crate) fn forget_collider(removed: On<Remove<MorphCollider>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<ColliderState>();
}

/// Adds the state to a collider, where Bevy cannot do so because there were colliders before the plugin.
pub(crate) fn add_state(added: On<Add<MorphCollider>>, mut commands: Commands) {
    commands
        .entity(added.entity)
        .try_insert_if_new(ColliderState::default());
}
