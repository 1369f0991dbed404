//! Colliders that collisions may see as they were a moment ago.
//!
//! A collider with a [tolerance](crate::MorphCollider::tolerance) has a second pose, in the state in which it was last taken over. Broad and narrow phase go by that state
//! alone, so that all pairs of the collider agree about it, new ones included, and it stays blended while other colliders move. It is taken over
//! again when the bound on how far any point has moved since exceeds the tolerance.

use std::sync::Arc;

use morph_collision::{Body, Pose};

use crate::collider::{ColliderState, Form, LockedPose, Placement};

/// A collider as collisions see it.
pub(crate) struct Held {
    /// That of a mesh; a shape has none.
    pub(crate) pose: Option<LockedPose>,
    pub(crate) placed: Placement,
    /// The tolerance it was last compared by.
    tolerance: f32,
    /// Whether the collider has changed since it was taken over.
    is_behind: bool,
}

impl ColliderState {
    /// How collisions see the collider; `None` if it takes no part.
    pub(crate) fn seen_as(&self) -> Option<&Placement> {
        let held = self.held.as_ref().map(|held| &held.placed);
        held.or(self.placed.as_ref())
    }

    /// Takes the collider over for collisions unless it has moved by no more than its tolerance since that was done last. Returns whether collisions
    /// see it as it was in an earlier run.
    pub(crate) fn follow(&mut self, stale: bool, tolerance: f32) -> bool {
        let Some(placed) = self.placed.filter(|_| tolerance > 0.0) else {
            // The last answers may be about an earlier state.
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
                held.take_pose(pose);
                held.placed = placed;
                held.tolerance = tolerance;
                held.is_behind = false;
            }
            None => {
                self.held = Some(Box::new(Held {
                    pose: pose.cloned().map(LockedPose::new),
                    placed,
                    tolerance,
                    is_behind: false,
                }));
            }
        }
        false
    }
}

impl Held {
    /// Whether only poses and places differ, and no point has moved by more than the tolerance.
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

    /// Brings the pose to the state of another one, and keeps of what it has blended whatever is still right.
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
