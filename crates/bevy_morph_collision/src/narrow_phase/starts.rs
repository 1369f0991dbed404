//! Where the meshes of continuous pairs were in the last run.

use std::sync::Arc;

use bevy::ecs::entity::EntityHashMap;
use morph_collision::{Aabb, Pose, WorldFromModel};

use super::comparison::Job;
use super::participant::{Placed, UsedMesh};
use crate::broad_phase::SweptPairs;
use crate::state::{Form, LockedPose};

/// Where meshes were in the last run. One that is needed again keeps its second pose, and what is blended in it.
#[derive(Default)]
pub(super) struct Starts(EntityHashMap<Start>);

/// Where a mesh was, and its shape there.
pub(super) struct Start {
    /// Around the mesh, in the world.
    pub(super) bounds: Aabb,
    place: WorldFromModel,
    pose: LockedPose,
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
        let known = self.0.remove(&placed.entity).map(|start| start.pose);
        if let Some(start) = Start::new(placed, swept, known) {
            self.0.insert(placed.entity, start);
        }
    }
}

impl Start {
    /// `None` if it was not there. `known` is its second pose, if it has one already.
    fn new(placed: &Placed<'_>, swept: &SweptPairs, known: Option<LockedPose>) -> Option<Self> {
        let before = swept.before(placed.entity)?;
        let Form::Mesh(place) = before.form else {
            return None;
        };
        let bounds = before.bounds;
        let now = placed.pose.as_ref()?.lock();
        let known = known.filter(|pose| Arc::ptr_eq(pose.lock().bvh(), now.bvh()));
        let mut pose = known.unwrap_or_else(|| LockedPose::new(Pose::new(now.bvh().clone())));
        let before = pose.get_mut();
        let is_known = if placed.changed {
            placed.before.restore(before)
        } else {
            let joints = now.joints().is_none_or(|joints| before.set_joints(joints).is_ok());
            joints && before.set_weights(now.weights()).is_ok()
        };
        let is_used = true;
        is_known.then_some(Self {
            bounds,
            place,
            pose,
            is_used,
        })
    }

    /// The mesh, for queries. Waits while another thread uses it.
    pub(super) fn mesh(&self) -> UsedMesh<'_> {
        UsedMesh {
            pose: self.pose.lock(),
            place: &self.place,
        }
    }
}
