//! Colliders with a tolerance, which collisions may see in an earlier state.
//!
//! A collider with a [tolerance](crate::MorphCollider::tolerance) has a second pose that holds an earlier state. Broad and narrow
//! phase use only that state, so all pairs of the collider agree on it, including new pairs, and it stays blended while other
//! colliders move. The second pose is updated when the bound on how far any point has moved since then exceeds the tolerance.

use std::sync::Arc;

use morph_collision::{Body, Pose, PoseSnapshot};

use super::collider_state::ColliderState;
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
    /// Whether the collider has changed since this state was taken.
    is_behind: bool,
}

impl ColliderState {
    /// How collisions see the collider; `None` if it takes no part.
    pub(crate) fn seen_as(&self) -> Option<&Placement> {
        let held = self.held.as_ref().map(|held| &held.placed);
        held.or(self.placed.as_ref())
    }

    /// Updates the state that collisions see, unless the collider has moved by at most its tolerance since the last update.
    /// Returns whether collisions see an earlier state.
    pub(crate) fn follow(&mut self, stale: bool, tolerance: f32) -> bool {
        let Some(placed) = self.placed.filter(|_| tolerance > 0.0) else {
            // The last answers may be for an earlier state.
            self.changed |= self.held.take().is_some_and(|held| held.is_behind);
            return false;
        };
        if let Some(held) = &mut self.held
            && !stale
        {
            let same_tolerance = held.tolerance == tolerance;
            held.tolerance = tolerance;
            if !self.changed && same_tolerance {
                return held.is_behind;
            }
            if held.is_within(self.pose.as_mut().map(LockedPose::get_mut), &placed, tolerance) {
                held.is_behind |= self.changed;
                self.changed = false;
                return held.is_behind;
            }
        }
        self.changed = true;
        let is_mesh = matches!(placed.form, Form::Mesh(_));
        let pose = self.pose.as_mut().filter(|_| is_mesh).map(|pose| &*pose.get_mut());
        match &mut self.held {
            Some(held) => {
                if let Some(before) = &mut held.pose {
                    held.before.take(before.get_mut());
                }
                held.take_pose(pose);
                held.placed = placed;
                held.tolerance = tolerance;
                held.is_behind = false;
            }
            None => {
                self.held = Some(Box::new(Held {
                    pose: pose.cloned().map(LockedPose::new),
                    placed,
                    before: self.before.shape.clone(),
                    tolerance,
                    is_behind: false,
                }));
            }
        }
        false
    }
}

impl Held {
    /// Whether only poses and transforms differ, and no point has moved by more than the tolerance.
    fn is_within(&mut self, pose: Option<&mut Pose>, placed: &Placement, tolerance: f32) -> bool {
        let Placement { form, bounds, .. } = self.placed;
        let rest = Placement {
            form,
            bounds,
            ..*placed
        };
        if rest != self.placed {
            return false;
        }
        let tolerance = f64::from(tolerance);
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
