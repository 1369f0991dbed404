//! The joint matrices of skeletons, computed as Bevy computes them for drawing, and shared by the meshes of a skeleton.

use bevy::asset::AssetId;
use bevy::math::{Affine3A, Mat3A, Vec3A};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use morph_collision::{InputError, JointMatrices};

/// Inverse bind poses of all skeletons.
pub type BindPoses = Assets<SkinnedMeshInverseBindposes>;

/// The skeletons in use. Meshes with the same joints and the same inverse bind poses share a skeleton.
#[derive(Default)]
#[allow(missing_debug_implementations)]
pub struct Skeletons {
    /// Keyed by bind poses and first joint, which nearly always identifies a skeleton.
    by_start: HashMap<(AssetId<SkinnedMeshInverseBindposes>, Option<Entity>), Vec<Skeleton>>,
    moment: u32,
    scratch: Vec<Affine3A>,
}

/// One skeleton.
#[derive(Default)]
#[allow(missing_debug_implementations)]
pub struct Skeleton {
    joints: Vec<Entity>,
    /// The last computed matrices, valid or not.
    world_from_mesh: Vec<Affine3A>,
    /// The last valid matrices.
    matrices: Option<JointMatrices>,
    /// Why the current matrices are invalid, with the index of the joint.
    problem: Option<(usize, InputError)>,
    /// Whether the problem has been reported.
    pub(crate) is_reported: bool,
    /// When the skeleton was last updated.
    moment: Option<u32>,
    is_used: bool,
}

impl Skeleton {
    /// The matrices of the joints. While some are invalid, the last valid ones; `None` if they were never valid.
    pub(crate) fn matrices(&self) -> Option<&JointMatrices> {
        self.matrices.as_ref()
    }

    /// The current matrices; `None` while some are invalid.
    #[must_use]
    pub fn world_from_mesh(&self) -> Option<&[Affine3A]> {
        self.problem.is_none().then_some(&self.world_from_mesh)
    }

    /// A joint whose current matrix is invalid, and why.
    pub(crate) fn problem(&self) -> Option<(Entity, &InputError)> {
        let (joint, error) = self.problem.as_ref()?;
        Some((*self.joints.get(*joint)?, error))
    }

    /// Updates the matrices from the current transforms of the joints.
    fn update(
        &mut self,
        bind_poses: Option<&SkinnedMeshInverseBindposes>,
        global_of: impl Fn(Entity) -> Option<Affine3A>,
        scratch: &mut Vec<Affine3A>,
    ) {
        scratch.clear();
        for (i, &joint) in self.joints.iter().enumerate() {
            let bind_pose = bind_poses.and_then(|poses| poses.get(i));
            let matrix = bind_pose.zip(global_of(joint)).map(|(bind_pose, global)| {
                // The last row of a bind pose does not affect where vertices are drawn.
                let columns = (global * *bind_pose).to_cols_array_2d();
                let [x, y, z, t] = columns.map(|[x, y, z, _]| Vec3A::new(x, y, z));
                Affine3A {
                    matrix3: Mat3A::from_cols(x, y, z),
                    translation: t,
                }
            });
            // In Bevy's buffers, a despawned joint keeps its matrix.
            let before = self.world_from_mesh.get(i).copied();
            scratch.push(matrix.or(before).unwrap_or(Affine3A::IDENTITY));
        }
        let is_known = self.matrices.is_some() || self.problem.is_some();
        if is_known && *scratch == self.world_from_mesh {
            return;
        }
        std::mem::swap(&mut self.world_from_mesh, scratch);
        match JointMatrices::new(&self.world_from_mesh) {
            Ok(matrices) => {
                self.matrices = Some(matrices);
                self.problem = None;
                self.is_reported = false;
            }
            Err(error) => {
                let is_bad = |matrix| JointMatrices::new(std::slice::from_ref(matrix)).is_err();
                let joint = self.world_from_mesh.iter().position(is_bad);
                self.problem = Some((joint.unwrap_or_default(), error));
            }
        }
    }
}

impl Skeletons {
    /// Begins a new moment, in which every requested skeleton is updated. Drops the skeletons that were not requested since the
    /// last call.
    pub fn begin(&mut self) {
        self.by_start.retain(|_, skeletons| {
            skeletons.retain_mut(|skeleton| std::mem::take(&mut skeleton.is_used));
            !skeletons.is_empty()
        });
        self.outdate();
    }

    /// Updates skeletons again on their next request, because joints may have moved.
    pub fn outdate(&mut self) {
        self.moment = self.moment.wrapping_add(1);
    }

    /// The skeleton of a mesh. `global_of` returns the global transform of an entity that exists.
    ///
    /// Computes one matrix per joint for the first mesh of a skeleton in each moment.
    pub fn of(
        &mut self,
        skin: &SkinnedMesh,
        bind_poses: Option<&BindPoses>,
        global_of: impl Fn(Entity) -> Option<Affine3A>,
    ) -> &mut Skeleton {
        let id = skin.inverse_bindposes.id();
        let start = (id, skin.joints.first().copied());
        let skeletons = self.by_start.entry(start).or_default();
        let known = skeletons.iter().position(|skeleton| skeleton.joints == skin.joints);
        let place = known.unwrap_or_else(|| {
            skeletons.push(Skeleton {
                joints: skin.joints.clone(),
                ..default()
            });
            skeletons.len() - 1
        });
        let skeleton = &mut skeletons[place];
        skeleton.is_used = true;
        if skeleton.moment.replace(self.moment) != Some(self.moment) {
            let bind_poses = bind_poses.and_then(|assets| assets.get(id));
            skeleton.update(bind_poses, global_of, &mut self.scratch);
        }
        skeleton
    }
}
