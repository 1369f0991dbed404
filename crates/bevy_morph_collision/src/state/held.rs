//! Colliders with a tolerance, which collisions may see in an earlier state.
//!
//! A collider with a [tolerance](crate::MorphCollider::tolerance) has a second pose that holds an earlier state. Broad and narrow
//! phase use only that state, so all pairs of the collider agree on it, including new pairs, and it stays blended while other
//! colliders move. The second pose is updated when the bound on how far any point has moved since then exceeds the tolerance.

use std::sync::Arc;

use morph_collision::{Body, Pose, PoseSnapshot};

use super::locked_pose::LockedPose;
use super::placement::{Form, Placement};

/// The state in which collisions see a collider.
pub(crate) struct Held {
    /// The pose of a mesh; `None` for a shape.
    pub(crate) pose: Option<LockedPose>,
    pub(crate) placed: Placement,
    /// The shape of a mesh before the last update of this state.
    pub(crate) before: PoseSnapshot,
    /// The tolerance at the last comparison.
    tolerance: f32,
}

/// What later runs depend on of a [`Held`].
#[derive(Clone)]
pub(super) struct HeldMemory {
    pose: Option<PoseSnapshot>,
    pub(super) placed: Placement,
    before: PoseSnapshot,
    tolerance: f32,
}

impl Held {
    pub(super) fn memory(&self) -> HeldMemory {
        HeldMemory {
            pose: self.pose.as_ref().map(LockedPose::snapshot),
            placed: self.placed.clone(),
            before: self.before.clone(),
            tolerance: self.tolerance,
        }
    }

    /// The state that a memory is of. It takes over the pose of another one.
    pub(super) fn restored(held: Option<Box<Self>>, memory: &HeldMemory) -> Self {
        let mut pose = held.and_then(|held| held.pose);
        LockedPose::restore(&mut pose, memory.pose.as_ref());
        Self {
            pose,
            placed: memory.placed.clone(),
            before: memory.before.clone(),
            tolerance: memory.tolerance,
        }
    }

    pub(super) fn new(pose: Option<&Pose>, placed: Placement, before: PoseSnapshot, tolerance: f32) -> Self {
        Self {
            pose: pose.cloned().map(LockedPose::new),
            placed,
            before,
            tolerance,
        }
    }

    /// Takes over the current state.
    pub(super) fn update(&mut self, pose: Option<&Pose>, placed: Placement, tolerance: f32) {
        if let Some(before) = &mut self.pose {
            self.before.take(before.get_mut());
        }
        self.take_pose(pose);
        self.placed = placed;
        self.tolerance = tolerance;
    }

    /// Returns whether it is the same tolerance as before.
    pub(super) fn set_tolerance(&mut self, tolerance: f32) -> bool {
        std::mem::replace(&mut self.tolerance, tolerance) == tolerance
    }

    /// Whether it has shown the current state once since the collider lost its tolerance.
    pub(super) fn is_released(&self) -> bool {
        self.tolerance == 0.0
    }

    /// Whether only poses and transforms differ, and no point has moved by more than the tolerance.
    pub(super) fn is_within_tolerance(&mut self, pose: Option<&mut Pose>, placed: &Placement) -> bool {
        let rest = Placement {
            form: self.placed.form.clone(),
            bounds: self.placed.bounds,
            ..placed.clone()
        };
        if rest != self.placed {
            return false;
        }
        let tolerance = f64::from(self.tolerance);
        match (&self.placed.form, &placed.form, &mut self.pose, pose) {
            (Form::Mesh(from), Form::Mesh(to), Some(before), Some(now)) => {
                Body::new(now, to).moved_at_most(tolerance, Body::new(before.get_mut(), from))
            }
            (Form::Shape(before), Form::Shape(now), ..) => now.displacement_from(before) <= tolerance,
            _ => false,
        }
    }

    /// Copies the state of another pose. Keeps all blended values that are still valid.
    fn take_pose(&mut self, pose: Option<&Pose>) {
        let fits = match (self.pose.as_mut().map(LockedPose::get_mut), pose) {
            (Some(own), Some(pose)) => {
                let joints = pose.joints().is_none_or(|joints| own.set_joints(joints).is_ok());
                Arc::ptr_eq(own.bvh(), pose.bvh()) && joints && own.set_weights(pose.weights()).is_ok()
            }
            _ => false,
        };
        if !fits {
            self.pose = pose.cloned().map(LockedPose::new);
        }
    }
}
