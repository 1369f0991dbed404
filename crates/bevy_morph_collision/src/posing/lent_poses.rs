//! Poses separate from those of colliders, for systems that follow the drawn mesh.

use std::sync::Arc;

use bevy::platform::collections::HashMap;
use morph_collision::{MorphBvh, Pose};

use crate::import::TreeKey;

/// One pose per tree, lent in turn to every entity that shows the mesh.
#[derive(Default)]
pub(crate) struct LentPoses(HashMap<TreeKey, (Pose, bool)>);

impl LentPoses {
    /// Drops the poses that were not lent since the last call.
    pub(crate) fn drop_unused(&mut self) {
        self.0.retain(|_, (_, used)| std::mem::take(used));
    }

    /// A pose of a tree, with arbitrary weights and joints.
    pub(crate) fn lend(&mut self, key: TreeKey, tree: &Arc<MorphBvh>) -> &mut Pose {
        let (pose, used) = self.0.entry(key).or_insert_with(|| (Pose::new(tree.clone()), true));
        *used = true;
        if !Arc::ptr_eq(pose.bvh(), tree) {
            *pose = Pose::new(tree.clone());
        }
        pose
    }
}
