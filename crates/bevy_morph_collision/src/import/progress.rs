//! How far the trees are.

use bevy::platform::collections::HashSet;
use bevy::prelude::*;

use super::mesh_data::ImportError;
use super::mesh_tree::MeshTree;
use super::tree_key::TreeKey;
use super::trees::MorphTrees;

/// How many trees there are, and what has become of them; see [`MorphTrees::progress`].
///
/// A tree is counted as long as it is kept. One that is built again, because its mesh was modified, is neither built nor failed until that is done.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct MorphTreeProgress {
    /// All that anyone has asked for, those whose mesh is not loaded yet included.
    pub requested: usize,
    /// Those that are ready.
    pub built: usize,
    /// Those whose mesh cannot be used.
    pub failed: usize,
}

impl MorphTreeProgress {
    /// Whether all trees are built or have failed. Also true if there are none: a loading screen that asks before its models are spawned ends at once.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.built + self.failed == self.requested
    }

    /// The part of the trees that are built or have failed, from 0 to 1; 1 if there are none.
    #[must_use]
    pub fn fraction(&self) -> f32 {
        if self.requested == 0 {
            return 1.0;
        }
        (self.built + self.failed) as f32 / self.requested as f32
    }
}

impl MorphTrees {
    /// How far the trees are that anyone has asked for: for loading screens.
    ///
    /// A tree is asked for when its collider is there; those of a glTF scene, when the scene is spawned. A mesh that is never loaded is waited for. Use
    /// [`MorphColliderSceneReady`](crate::MorphColliderSceneReady) to know when one scene is complete.
    #[must_use]
    pub fn progress(&self) -> MorphTreeProgress {
        let count = |is: fn(&MeshTree) -> bool| self.of_mesh.values().filter(|entry| is(entry)).count();
        MorphTreeProgress {
            requested: self.of_mesh.len() + self.waiting.len(),
            built: count(|entry| !entry.is_coming() && entry.error.is_none()),
            failed: count(|entry| !entry.is_coming() && entry.error.is_some()),
        }
    }

    /// Whether the mesh as it is now has a tree, or why it has none; `None` while that is not known.
    pub(crate) fn outcome(&self, key: TreeKey) -> Option<Result<(), &ImportError>> {
        let entry = self.of_mesh.get(&key).filter(|entry| !entry.is_coming())?;
        Some(entry.error.as_ref().map_or(Ok(()), Err))
    }

    /// The trees that are new, or have failed, since it was called last.
    pub(crate) fn take_news(&mut self) -> HashSet<TreeKey> {
        let taken = |(key, entry): (&TreeKey, &mut MeshTree)| std::mem::take(&mut entry.is_news).then_some(*key);
        self.of_mesh.iter_mut().filter_map(taken).collect()
    }
}
