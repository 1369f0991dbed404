//! What the plugin keeps for each collider.

use super::bad_weights::BadWeights;
use super::held::Held;
use super::locked_pose::LockedPose;
use super::placement::{Form, Placement};
use super::previous::Previous;
use super::readiness::Readiness;
use crate::components::MorphCollider;
use crate::import::TreeKey;
use std::sync::Arc;

use super::freshness::Freshness;
use bevy::prelude::*;
use morph_collision::MorphBvh;
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
    pub(crate) previous: Previous,
    /// What has changed about it since the last run.
    pub(crate) freshness: Freshness,
    /// Which problem with its weights has been logged, so that it is not logged every frame.
    pub(crate) bad_weights: BadWeights,
    /// The same for its position and size.
    pub(crate) bad_placement: bool,
    /// Which readiness event the collider got last.
    pub(crate) reported: Readiness,
}

impl ColliderState {
    pub(crate) fn pose_mut(&mut self) -> Option<&mut Pose> {
        self.pose.as_mut().map(LockedPose::get_mut)
    }
}

impl ColliderState {
    /// How collisions see the collider; `None` if it takes no part.
    pub(crate) fn seen_as(&self) -> Option<&Placement> {
        let held = self.held.as_ref().map(|held| &held.placed);
        held.or(self.placed.as_ref())
    }

    /// Updates the state that collisions see, unless the collider has moved by at most its tolerance since the last update.
    /// Returns whether collisions see an earlier state.
    pub(crate) fn hold(&mut self, was_absent: bool, tolerance: f32) -> bool {
        // An earlier state is shown for one more run, as the start of a motion, before the current one takes its place.
        let is_released = self.held.as_ref().is_some_and(|held| held.is_released() || was_absent);
        let holds = tolerance > 0.0 || (self.held.is_some() && !is_released);
        let Some(placed) = self.placed.as_ref().filter(|_| holds).cloned() else {
            self.held = None;
            self.freshness.stop_holding();
            return false;
        };
        if let Some(held) = &mut self.held
            && !was_absent
        {
            let same_tolerance = held.set_tolerance(tolerance);
            if !self.freshness.answers_are_old() && same_tolerance {
                return self.freshness.is_held_back();
            }
            if held.is_within_tolerance(self.pose.as_mut().map(LockedPose::get_mut), &placed) {
                self.freshness.hold_back();
                return self.freshness.is_held_back();
            }
        }
        self.freshness.show_current();
        let is_mesh = matches!(placed.form, Form::Mesh(_));
        let pose = self.pose.as_mut().filter(|_| is_mesh).map(|pose| &*pose.get_mut());
        match &mut self.held {
            Some(held) => held.update(pose, placed, tolerance),
            None => {
                self.held = Some(Box::new(Held::new(
                    pose,
                    placed,
                    self.previous.shape.clone(),
                    tolerance,
                )));
            }
        }
        false
    }

    /// Gives the collider a new pose if its tree is another one, or takes its pose if there is no tree. `key` is the tree that it has or
    /// waits for. Returns whether the pose is another one.
    pub(crate) fn take_tree(&mut self, key: Option<TreeKey>, tree: Option<&Arc<MorphBvh>>) -> bool {
        self.tree = key;
        let mut before = self.pose.take();
        let is_current = match (tree, before.as_mut().map(|pose| pose.get_mut().bvh())) {
            (Some(tree), Some(current)) => Arc::ptr_eq(tree, current),
            (None, None) => true,
            _ => false,
        };
        if is_current {
            self.pose = before;
            return false;
        }
        let before = before.as_mut().map(LockedPose::get_mut);
        let mut pose = tree.map(|tree| Pose::new(tree.clone()));
        if let (Some(pose), Some(before)) = (&mut pose, &before) {
            // The last valid weights stay in use if the next ones are invalid. If the number of targets changed, the pose starts
            // at rest.
            let _fits = pose.set_weights(before.weights());
        }
        // The same for joints.
        let joints = before
            .as_ref()
            .and_then(|pose| pose.joints())
            .filter(|_| self.has_joints);
        let carried = pose.as_mut().zip(joints).map(|(pose, joints)| pose.set_joints(joints));
        self.has_joints = matches!(carried, Some(Ok(_)));
        self.pose = pose.map(LockedPose::new);
        self.freshness.pose_changed();
        true
    }
}

/// Removes the plugin's state together with [`MorphCollider`].
pub(crate) fn forget_collider(removed: On<Remove<MorphCollider>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<ColliderState>();
}
