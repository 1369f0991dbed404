//! A pose that gets its weights and joints when somebody looks at it.

use std::sync::Arc;

use morph_collision::{MorphBvh, Pose, WeightsError, WorldFromModel};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Pose as Isometry;

use super::joints::SurfaceJoints;
use super::placed_bounds::PlacedBounds;
use crate::math::mapped;

/// A pose that gets its weights and joints when somebody looks at it. The joints of a skinned mesh are in the space of its collider.
pub struct LazyPose {
    pub(super) pose: Pose,
    weights: Vec<f32>,
    joints: Option<SurfaceJoints>,
    /// Whether the pose does not have these weights and joints yet.
    is_behind: bool,
    /// Whether somebody has looked at it since it got them.
    is_seen: bool,
    /// A box that needed no pose.
    pub(super) bounds: Option<PlacedBounds>,
}

impl LazyPose {
    /// Takes over a pose without joints.
    pub fn new(pose: Pose) -> Self {
        Self {
            weights: pose.weights().to_vec(),
            pose,
            joints: None,
            is_behind: false,
            is_seen: false,
            bounds: None,
        }
    }

    /// The tree of its mesh.
    pub fn bvh(&self) -> &Arc<MorphBvh> {
        self.pose.bvh()
    }

    /// Whether joints move the mesh.
    pub fn is_skinned(&self) -> bool {
        self.pose.joints().is_some()
    }

    /// Its weights.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// Its joints, if it has been given any.
    pub fn joints(&self) -> Option<&SurfaceJoints> {
        self.joints.as_ref()
    }

    /// Whether somebody has looked at it since it got its weights and joints.
    pub fn is_seen(&self) -> bool {
        self.is_seen
    }

    /// Sets the weights.
    ///
    /// # Errors
    /// They do not fit the mesh. It keeps its own.
    pub fn set_weights(&mut self, weights: &[f32]) -> Result<(), WeightsError> {
        if self.weights != weights {
            self.bvh().model().check_weights(weights)?;
            weights.clone_into(&mut self.weights);
            self.change();
        }
        Ok(())
    }

    /// Sets the joints. Returns whether they fit the mesh; otherwise it keeps its own.
    pub fn set_joints(&mut self, joints: &SurfaceJoints) -> bool {
        let fits = self.bvh().model().joint_count() == Some(joints.count());
        if fits && !self.joints.as_ref().is_some_and(|own| own.is_drawn_as(joints)) {
            self.joints = Some(joints.clone());
            self.change();
        }
        fits
    }

    /// Takes the weights and joints of another pose of the mesh.
    pub fn take(&mut self, other: &Self) {
        let _fits = self.set_weights(&other.weights);
        if let Some(joints) = &other.joints {
            self.set_joints(joints);
        }
    }

    fn change(&mut self) {
        self.is_behind = true;
        self.is_seen = false;
        self.bounds = None;
    }

    /// The pose.
    pub fn get(&mut self) -> &mut Pose {
        self.is_seen = true;
        self.compare()
    }

    /// The pose, for a look that does not count, because nothing is kept of what it sees.
    pub fn compare(&mut self) -> &mut Pose {
        if std::mem::take(&mut self.is_behind) {
            // Both were checked.
            let _fits = self.pose.set_weights(&self.weights);
            if let Some(joints) = &self.joints {
                let _fits = self.pose.set_joints(joints.in_collider());
            }
        }
        &mut self.pose
    }

    /// Finds a box that needs no pose, if there is one, until weights or joints change. Without it, bounds are those of the pose.
    pub fn find_bounds(&mut self) {
        self.bounds = self
            .joints
            .as_ref()
            .and_then(|joints| joints.bounds(self.pose.bvh(), &self.weights));
    }

    /// A box around the mesh in the collider's space, to which `collider_from_model` takes a mesh without joints. Poses nothing if a box is
    /// known.
    pub fn local_bounds(&mut self, collider_from_model: &WorldFromModel) -> Aabb {
        if let Some(bounds) = &self.bounds {
            return bounds.in_collider();
        }
        let bounds = self.get().broad_phase_bounds(collider_from_model);
        Aabb::new(bounds.min, bounds.max)
    }

    /// A box around the mesh while its collider is at `place`; `None` if it is known only in the collider's space.
    pub fn bounds_at(&self, place: &Isometry) -> Option<Aabb> {
        Some(self.bounds.as_ref()?.at(place))
    }

    /// A box around the mesh in world space.
    pub fn world_bounds(&mut self, world_from_model: &WorldFromModel) -> morph_collision::Aabb {
        if !self.is_skinned() {
            return self.get().world_bounds(world_from_model);
        }
        let known = self
            .bounds
            .as_ref()
            .and_then(|bounds| bounds.at_exactly(world_from_model));
        let of = |Aabb { mins: min, maxs: max }| morph_collision::Aabb { min, max };
        match known {
            Some(bounds) => of(bounds),
            None => mapped(&of(self.local_bounds(&WorldFromModel::IDENTITY)), world_from_model),
        }
    }
}
