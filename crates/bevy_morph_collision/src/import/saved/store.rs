//! What loaders and tasks leave for the systems: trees that were restored before anyone requested them, and messages.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use morph_collision::BuildOptions;

use super::super::mesh_data::Finished;

/// A tree that is restored, or will be.
pub(in crate::import) type Restoring = Pin<Box<dyn Future<Output = Finished> + Send>>;

/// The tree of a loaded mesh, as skeletons with a number of joints show it.
pub(super) struct Restored {
    pub(super) joints: Option<usize>,
    pub(super) options: BuildOptions,
    /// For messages.
    pub(super) file: String,
    pub(super) tree: Restoring,
}

/// Written from any thread.
#[derive(Resource, Clone, Default)]
pub(super) struct Store(Arc<Mutex<State>>);

#[derive(Default)]
pub(super) struct State {
    /// Trees that were saved beside models and are not used yet.
    pub(super) restored: HashMap<AssetId<Mesh>, Vec<Restored>>,
    pub(super) warnings: Vec<String>,
}

impl Store {
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Says why a file is not used for a mesh.
    pub(super) fn refuse(&self, file: &str, mesh: &str, reason: &str) {
        self.warn(format!(
            "`{file}` is not used for mesh `{mesh}`, whose tree is built instead: {reason}"
        ));
    }

    pub(super) fn warn(&self, warning: String) {
        self.lock().warnings.push(warning);
    }
}
