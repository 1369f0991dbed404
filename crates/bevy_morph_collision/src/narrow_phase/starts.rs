//! Where colliders of continuous pairs were in the last run.

use std::sync::Arc;

use bevy::ecs::entity::EntityHashMap;
use morph_collision::Pose;

use super::builders::Job;
use super::{Placed, UsedMesh};
use crate::collider::{Form, LockedPose};
use crate::continuous::SweptPairs;

/// Where colliders were in the last run. A mesh that is needed again keeps its second pose, and what is blended in it.
#[derive(Default)]
pub(super) struct Starts(EntityHashMap<Start>);

/// Where a collider was.
pub(super) struct Start {
    pub(super) form: Form,
    /// The pose of a mesh; `None` for a shape.
    pub(super) pose: Option<LockedPose>,
    is_used: bool,
}

impl Starts {
    /// Where a collider was; `None` if that is not known, so that it has no way.
    pub(super) fn of(&self, placed: &Placed<'_>) -> Option<&Start> {
        self.0.get(&placed.entity)
    }

    /// Prepares all colliders of pairs to compare on their way, and drops those that are not needed any more. Returns the number of pairs.
    pub(super) fn prepare(&mut self, jobs: &[Job], placed: &[Placed<'_>], swept: &SweptPairs) -> u64 {
        if jobs.is_empty() && self.0.is_empty() {
            return 0;
        }
        self.0.values_mut().for_each(|start| start.is_used = false);
        let mut pairs = 0;
        for job in jobs.iter().filter(|job| job.asked.is_swept) {
            pairs += 1;
            for place in [job.asked.places.0, job.asked.places.1] {
                self.add(&placed[place], swept);
            }
        }
        self.0.retain(|_, start| start.is_used);
        pairs
    }

    fn add(&mut self, placed: &Placed<'_>, swept: &SweptPairs) {
        if self.0.get(&placed.entity).is_some_and(|start| start.is_used) {
            return;
        }
        let known = self.0.remove(&placed.entity).and_then(|start| start.pose);
        if let Some(start) = Start::new(placed, swept, known) {
            self.0.insert(placed.entity, start);
        }
    }
}

impl Start {
    fn new(placed: &Placed<'_>, swept: &SweptPairs, known: Option<LockedPose>) -> Option<Self> {
        let form = swept.before(placed.entity)?.form;
        let pose = match (&form, &placed.placement.form) {
            (Form::Mesh(_), Form::Mesh(_)) => {
                let now = placed.pose.as_ref()?.lock();
                let is_same = |pose: &LockedPose| Arc::ptr_eq(pose.lock().bvh(), now.bvh());
                let known = known.filter(is_same);
                let mut pose = known.unwrap_or_else(|| LockedPose::new(Pose::new(now.bvh().clone())));
                let before = pose.get_mut();
                let is_known = if placed.changed {
                    placed.before.restore(before)
                } else {
                    let joints = now.joints().is_none_or(|joints| before.set_joints(joints).is_ok());
                    joints && before.set_weights(now.weights()).is_ok()
                };
                Some(pose).filter(|_| is_known)
            }
            (Form::Shape(_), Form::Shape(_)) => None,
            _ => return None,
        };
        let is_used = true;
        Some(Self { form, pose, is_used })
    }

    /// The mesh, for queries; `None` for a shape. Waits while another thread uses it.
    pub(super) fn mesh(&self) -> Option<UsedMesh<'_>> {
        match (&self.form, &self.pose) {
            (Form::Mesh(place), Some(pose)) => Some(UsedMesh {
                pose: pose.lock(),
                place,
            }),
            _ => None,
        }
    }
}
