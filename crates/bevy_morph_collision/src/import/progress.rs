//! Progress of building trees.

use bevy::platform::collections::HashSet;
use bevy::prelude::*;

use super::error::ImportError;
use super::mesh_tree::MeshTree;
use super::tree_key::TreeKey;
use super::trees::MorphTrees;

/// How many trees there are and how far they are; see [`MorphTrees::progress`].
///
/// A tree is counted as long as it is kept. While a tree is rebuilt because its mesh was modified, it counts as neither built nor
/// failed.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct MorphTreeProgress {
    /// All requested trees, including those whose mesh is not loaded yet.
    pub requested: usize,
    /// Trees that are ready.
    pub built: usize,
    /// Trees whose mesh cannot be used, or could not be loaded.
    pub failed: usize,
}

impl MorphTreeProgress {
    /// Whether all trees are built or have failed. Also true if there are none, so a loading screen that checks before its models
    /// are spawned ends at once.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.built + self.failed == self.requested
    }

    /// The fraction of trees that are built or have failed, from 0 to 1; 1 if there are none.
    #[must_use]
    pub fn fraction(&self) -> f32 {
        if self.requested == 0 {
            return 1.0;
        }
        (self.built + self.failed) as f32 / self.requested as f32
    }
}

impl MorphTrees {
    /// The progress of all requested trees, for loading screens.
    ///
    /// A tree is requested as soon as its collider exists; for a glTF scene, when the scene is spawned. A mesh that
    /// nobody loads or adds to `Assets<Mesh>` stays pending, and a warning in the log says so. Use
    /// [`MorphColliderSceneReady`](crate::setup::MorphColliderSceneReady) to know when one scene is complete.
    #[must_use]
    pub fn progress(&self) -> MorphTreeProgress {
        let count = |is: fn(&MeshTree) -> bool| self.of_mesh.values().filter(|entry| is(entry)).count();
        MorphTreeProgress {
            requested: self.of_mesh.len() + self.waiting.len(),
            built: count(|entry| !entry.is_coming() && entry.error.is_none()),
            failed: count(|entry| !entry.is_coming() && entry.error.is_some()),
        }
    }

    /// The requested trees whose mesh is not there yet, with the entities that requested them.
    pub(crate) fn waiting(&self) -> impl Iterator<Item = (TreeKey, Entity)> {
        self.waiting.iter().copied()
    }

    /// The trees of skinned meshes, with the entities that requested them and the error of their joint weights: see
    /// [`MorphModel::joint_weight_error`](morph_collision::MorphModel::joint_weight_error).
    pub(crate) fn joint_weight_errors(&self) -> impl Iterator<Item = (TreeKey, Entity, f64)> {
        self.of_mesh.iter().filter_map(|(key, entry)| {
            let error = entry.tree.as_ref()?.model().joint_weight_error()?;
            Some((*key, entry.asked_by, error))
        })
    }

    /// Whether the current state of the mesh has a tree, or why it has none; `None` while that is not known.
    pub(crate) fn outcome(&self, key: TreeKey) -> Option<Result<(), &ImportError>> {
        let entry = self.of_mesh.get(&key).filter(|entry| !entry.is_coming())?;
        Some(entry.error.as_ref().map_or(Ok(()), Err))
    }

    /// The trees that are new, or have failed, since the last call.
    pub(crate) fn take_news(&mut self) -> HashSet<TreeKey> {
        let taken = |(key, entry): (&TreeKey, &mut MeshTree)| std::mem::take(&mut entry.is_news).then_some(*key);
        self.of_mesh.iter_mut().filter_map(taken).collect()
    }
}
