//! Where the colliders of continuous pairs were in the last run.

use std::sync::Arc;

use bevy::ecs::entity::EntityHashMap;
use morph_collision::motion::MovingShape;
use morph_collision::{Aabb, Pose, WorldFromModel};

use super::comparison::{Comparison, Job};
use super::participant::{PlacedCollider, UsedMesh};
use crate::broad_phase::SweptPairs;
use crate::state::{Form, LockedPose};

/// Where colliders were in the last run. A mesh that is needed again keeps its second pose, and what is blended in it.
#[derive(Default)]
pub(super) struct Starts(EntityHashMap<Start>);

/// Where a collider was.
pub(super) struct Start {
    /// Around it, in the world.
    pub(super) bounds: Aabb,
    pub(super) form: StartForm,
    is_used: bool,
}

/// What a collider was like there.
pub(super) enum StartForm {
    Mesh {
        world_from_model: WorldFromModel,
        pose: Box<LockedPose>,
    },
    /// Its way to where it is now.
    Shape(MovingShape),
}

/// What comparisons of a run read.
#[derive(Clone, Copy)]
pub(super) struct RunView<'a> {
    /// The colliders that take part, in ascending order.
    pub(super) colliders: &'a [PlacedCollider<'a>],
    pub(super) starts: &'a Starts,
    /// The time since the last run; 0 if it is not known.
    pub(super) seconds: f64,
    /// The maximum number of triangle pairs in a contact.
    pub(super) limit: usize,
    /// Whether the work of each pair is counted.
    pub(super) counts_pairs: bool,
}

impl<'a> RunView<'a> {
    /// The two colliders of a comparison.
    pub(super) fn pair(&self, comparison: Comparison) -> [&'a PlacedCollider<'a>; 2] {
        let (a, b) = comparison.indices;
        [&self.colliders[a], &self.colliders[b]]
    }
}

impl Starts {
    /// Where a collider was; `None` if that is not known, so that it has no way.
    pub(super) fn of(&self, placed: &PlacedCollider<'_>) -> Option<&Start> {
        self.0.get(&placed.entity)
    }

    /// Prepares all colliders of pairs to compare on their way, and drops those that are not needed any more. Returns the number of pairs.
    pub(super) fn prepare(&mut self, jobs: &[Job], placed: &[PlacedCollider<'_>], swept: &SweptPairs) -> u64 {
        if jobs.is_empty() && self.0.is_empty() {
            return 0;
        }
        self.0.values_mut().for_each(|start| start.is_used = false);
        let mut pairs = 0;
        for job in jobs.iter().filter(|job| job.comparison.is_swept) {
            pairs += 1;
            for index in [job.comparison.indices.0, job.comparison.indices.1] {
                self.add(&placed[index], swept);
            }
        }
        self.0.retain(|_, start| start.is_used);
        pairs
    }

    fn add(&mut self, placed: &PlacedCollider<'_>, swept: &SweptPairs) {
        if self.0.get(&placed.entity).is_some_and(|start| start.is_used) {
            return;
        }
        let known = self.0.remove(&placed.entity).and_then(|start| match start.form {
            StartForm::Mesh { pose, .. } => Some(*pose),
            StartForm::Shape(_) => None,
        });
        if let Some(start) = Start::new(placed, swept, known) {
            self.0.insert(placed.entity, start);
        }
    }
}

impl Start {
    /// `None` if it was not there. `known` is its second pose, if it has one already.
    fn new(placed: &PlacedCollider<'_>, swept: &SweptPairs, known: Option<LockedPose>) -> Option<Self> {
        let before = swept.before(placed.entity)?;
        let bounds = before.bounds;
        let is_used = true;
        let world_from_model = match (&before.form, &placed.placement.form) {
            (Form::Mesh(world_from_model), Form::Mesh(_)) => *world_from_model,
            (Form::Shape(from), Form::Shape(to)) => {
                let form = StartForm::Shape(MovingShape::between(from, to)?);
                return Some(Self { bounds, form, is_used });
            }
            _ => return None,
        };
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
        let pose = Box::new(pose);
        let form = StartForm::Mesh { world_from_model, pose };
        is_known.then_some(Self { bounds, form, is_used })
    }

    /// The mesh, for queries; `None` for a shape. Waits while another thread uses it.
    pub(super) fn mesh(&self) -> Option<UsedMesh<'_>> {
        match &self.form {
            StartForm::Mesh { world_from_model, pose } => Some(UsedMesh {
                pose: pose.lock(),
                world_from_model,
            }),
            StartForm::Shape(_) => None,
        }
    }
}
