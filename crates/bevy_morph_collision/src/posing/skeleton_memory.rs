//! What later runs depend on of skeletons, to go back to it.
//!
//! A joint that is despawned keeps its matrix, and while a matrix is invalid, the last valid ones of the skeleton stay in use.

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::math::Affine3A;
use bevy::prelude::*;
use morph_collision::JointMatrices;

use super::skeletons::{PosesId, Skeleton, Skeletons};

/// What later runs depend on of a skeleton.
#[derive(Clone)]
pub(crate) struct SkeletonMemory {
    bind_poses: PosesId,
    joints: Vec<Entity>,
    /// The last valid matrices.
    matrices: Option<JointMatrices>,
    /// The last matrices, if they are invalid.
    invalid: Option<Vec<Affine3A>>,
}

impl MapEntities for SkeletonMemory {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.joints.map_entities(mapper);
    }
}

impl Skeletons {
    pub(crate) fn memory(&self) -> Vec<SkeletonMemory> {
        let lists = self.by_start.iter().map(|(&(bind_poses, _), list)| (bind_poses, list));
        let all = lists.flat_map(|(bind_poses, list)| list.iter().map(move |skeleton| (bind_poses, skeleton)));
        all.map(|(bind_poses, skeleton)| SkeletonMemory {
            bind_poses,
            joints: skeleton.joints.clone(),
            matrices: skeleton.matrices.clone(),
            invalid: skeleton.problem.is_some().then(|| skeleton.world_from_mesh.clone()),
        })
        .collect()
    }

    /// Goes back to earlier skeletons. Each is updated on its next request. What has been reported stays.
    pub(crate) fn restore(&mut self, memories: &[SkeletonMemory]) {
        let later = std::mem::take(&mut self.by_start);
        for memory in memories {
            let start = (memory.bind_poses, memory.joints.first().copied());
            let mut same = later.get(&start).into_iter().flatten();
            let mut skeleton = Skeleton::default();
            skeleton.joints.clone_from(&memory.joints);
            skeleton.matrices.clone_from(&memory.matrices);
            skeleton.is_reported = same.any(|skeleton| skeleton.joints == memory.joints && skeleton.is_reported);
            match (&memory.invalid, &memory.matrices) {
                (Some(invalid), _) => {
                    skeleton.world_from_mesh.clone_from(invalid);
                    skeleton.check();
                }
                (None, Some(matrices)) => skeleton.world_from_mesh.extend(matrices.iter()),
                (None, None) => {}
            }
            self.by_start.entry(start).or_default().push(skeleton);
        }
        self.count = memories.len();
        self.outdate();
    }
}
