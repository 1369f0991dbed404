//! The state of a pose at one moment, to look up later.

use std::fmt;
use std::sync::{Arc, Weak};

use glam::DVec3;

use super::instance::Pose;
use crate::bounds::{WorldFromModel, with_simd};
use crate::exact::Triangle;
use crate::joints::JointMatrices;
use crate::model::Weights;
use crate::tree::MorphBvh;

/// The weights and joints of a pose at one moment, without its cache.
///
/// It returns single triangles as they were at that moment, for example to compute the velocity of a point on the surface. It does
/// not keep the mesh or its tree alive.
#[derive(Clone, Default)]
pub struct PoseSnapshot {
    bvh: Weak<MorphBvh>,
    weights: Weights,
    joints: Option<JointMatrices>,
}

impl PoseSnapshot {
    /// Stores the state of a pose. Cost: a copy of the weights; joints are shared.
    pub fn take(&mut self, pose: &Pose) {
        if !self.is_of(pose) {
            self.bvh = Arc::downgrade(&pose.bvh);
        }
        if self.weights.all() != pose.weights() {
            self.weights.set(pose.weights());
        }
        self.joints = pose.joints().cloned();
    }

    /// Returns whether the snapshot was taken from a pose of the same tree.
    #[must_use]
    pub fn is_of(&self, pose: &Pose) -> bool {
        std::ptr::eq(self.bvh.as_ptr(), Arc::as_ptr(&pose.bvh))
    }

    /// Gives the stored weights and joints to a pose of the same tree. Returns whether it is of the same tree; otherwise it stays as it is.
    ///
    /// Cost: as [`Pose::set_weights`] and [`Pose::set_joints`]. What the pose has blended for the same weights and joints stays valid.
    pub fn restore(&self, pose: &mut Pose) -> bool {
        self.is_of(pose)
            && pose.set_weights(self.weights.all()).is_ok()
            && self
                .joints
                .as_ref()
                .is_none_or(|joints| pose.set_joints(joints).is_ok())
    }

    /// Creates a pose in the stored state; `None` if the tree has been dropped, or if nothing was stored.
    #[must_use]
    pub fn to_pose(&self) -> Option<Pose> {
        let mut pose = Pose::new(self.bvh.upgrade()?);
        self.restore(&mut pose).then_some(pose)
    }

    /// Returns the corners of a triangle in world space as they were. `None` if there is no such triangle, or if the tree has been
    /// dropped.
    ///
    /// The corners are bit for bit those that [`Body::triangle`](crate::Body::triangle) returned. As there, a skinned mesh ignores
    /// `world_from_model`. Cost: every call blends three vertices.
    #[must_use]
    pub fn triangle(&self, triangle: u32, world_from_model: &WorldFromModel) -> Option<Triangle> {
        let bvh = self.bvh.upgrade()?;
        let model = bvh.model();
        let corners = model.triangle(triangle)?;
        let moved_by_joints = self.joints.as_ref().zip(model.skin());
        Some(corners.map(|vertex| {
            let position = model.blend_vertex(vertex, &self.weights);
            match moved_by_joints {
                Some((joints, skin)) => {
                    let [x, y, z, _] =
                        with_simd!(bvh.kernel().level, simd => skin.place(simd, vertex, position, joints));
                    DVec3::new(x, y, z)
                }
                None => world_from_model.transform_point(position.into()),
            }
        }))
    }
}

impl fmt::Debug for PoseSnapshot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PoseSnapshot")
            .field("weights", &self.weights.all())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Quat, Vec3};

    use super::*;
    use crate::{Body, BuildOptions, Influences, MorphModel};

    fn posed(skinned: bool, weight: f32, joint: Affine3A) -> Pose {
        let (base, triangles, targets) = (Vec3::AXES, [[0, 1, 2]], [[Vec3::new(0.3, 0.1, 0.7); 3]]);
        let model = if skinned {
            let influences = Influences {
                joints: &[[0, 1, 0, 0]; 3],
                weights: &[[0.3, 0.7, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
            };
            MorphModel::skinned(&base, &triangles, &targets, 2, &[influences])
        } else {
            MorphModel::from_displacements(&base, &triangles, &targets)
        };
        let mut pose = Pose::new(Arc::new(MorphBvh::build(
            Arc::new(model.unwrap()),
            &BuildOptions::default(),
        )));
        change(&mut pose, weight, joint);
        pose
    }

    fn change(pose: &mut Pose, weight: f32, joint: Affine3A) {
        pose.set_weights(&[weight]).unwrap();
        if pose.joints().is_some() {
            let joints = [joint, Affine3A::from_translation(Vec3::new(0.1, 5.0, -1.0))];
            pose.set_joints(&JointMatrices::new(&joints).unwrap()).unwrap();
        }
    }

    #[test]
    fn it_gives_triangles_as_they_were() {
        let place = Affine3A::from_rotation_translation(Quat::from_rotation_y(1.1), Vec3::new(3.0, 0.1, 7.0));
        let place = WorldFromModel::new(place).unwrap();
        for skinned in [false, true] {
            let mut pose = posed(skinned, 0.77, Affine3A::from_rotation_x(0.3));
            let then = Body::new(&mut pose, &place).triangle(0).unwrap();
            let mut snapshot = PoseSnapshot::default();
            assert!(!snapshot.is_of(&pose) && snapshot.triangle(0, &place).is_none());
            snapshot.take(&pose);
            change(&mut pose, -0.3, Affine3A::from_rotation_x(1.3));
            assert_ne!(Body::new(&mut pose, &place).triangle(0), Some(then));
            assert!(snapshot.is_of(&pose));
            assert_eq!(snapshot.triangle(0, &place), Some(then), "skinned: {skinned}");
            assert_eq!(snapshot.triangle(1, &place), None);
            // A pose of the same tree takes the state, another one does not.
            let mut other = Pose::new(pose.bvh().clone());
            assert!(snapshot.restore(&mut other));
            assert_eq!(Body::new(&mut other, &place).triangle(0), Some(then));
            let mut new = snapshot.to_pose().expect("the tree is kept");
            assert_eq!(Body::new(&mut new, &place).triangle(0), Some(then));
            let mut foreign = posed(skinned, 0.1, Affine3A::IDENTITY);
            assert!(!snapshot.restore(&mut foreign) && foreign.weights() == [0.1]);
            // A second call replaces weights and joints.
            snapshot.take(&pose);
            assert_eq!(snapshot.triangle(0, &place), Body::new(&mut pose, &place).triangle(0));
            // It keeps nothing alive.
            let tree = Arc::downgrade(pose.bvh());
            drop((pose, other, new));
            assert!(tree.upgrade().is_none() && snapshot.triangle(0, &place).is_none());
            assert!(snapshot.to_pose().is_none());
        }
    }
}
