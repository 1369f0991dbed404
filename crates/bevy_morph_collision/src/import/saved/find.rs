//! What was saved of a requested tree.

use bevy::asset::LoadState;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use morph_collision::BuildOptions;
use tracing::warn;

use super::super::tree_key::TreeKey;
use super::file::{MorphTreeFile, MorphTreeFrom};
use super::fit::{Layouts, other_options};
use super::store::{Restoring, State, Store};
use crate::app::Names;

/// The trees that were saved.
#[derive(SystemParam)]
pub(crate) struct SavedTrees<'w, 's> {
    store: Option<Res<'w, Store>>,
    files: Option<Res<'w, Assets<MorphTreeFile>>>,
    server: Option<Res<'w, AssetServer>>,
    given: Query<'w, 's, &'static MorphTreeFrom, Allow<Disabled>>,
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
}

/// What was saved of a tree.
pub(in crate::import) enum Saved {
    Nothing,
    /// The file is being loaded.
    Coming,
    /// Trees that may fit once the mesh is read.
    Layouts(Layouts),
    /// The tree itself.
    Tree(Restoring),
}

impl SavedTrees<'_, '_> {
    /// What was saved of the tree with a key, which an entity requests. `options` are those of the tree, if they are valid.
    pub(in crate::import) fn find(
        &self,
        key: &TreeKey,
        asked_by: Entity,
        options: Option<BuildOptions>,
        names: &Names,
    ) -> Saved {
        let (Some(store), Some(options)) = (self.store.as_deref(), options) else {
            return Saved::Nothing;
        };
        let mesh = || names.asset(key.mesh).unwrap_or_else(|| "without a file".to_owned());
        let above = || std::iter::once(asked_by).chain(self.parents.iter_ancestors(asked_by));
        if let Some(MorphTreeFrom(handle)) = above().find_map(|entity| self.given.get(entity).ok()) {
            let file = self.files.as_ref().and_then(|files| files.get(handle));
            let path = names.asset(handle.id()).unwrap_or_else(|| "a file of trees".to_owned());
            let state = self.server.as_ref().map(|server| server.load_state(handle.id()));
            return match (file, state) {
                (Some(file), _) => Saved::Layouts(Layouts {
                    file: file.0.clone(),
                    path,
                    mesh: mesh(),
                    store: store.clone(),
                }),
                (None, Some(LoadState::Loading)) => Saved::Coming,
                (None, _) => {
                    store.refuse(&path, &mesh(), "it is not loaded");
                    Saved::Nothing
                }
            };
        }
        Self::find_restored(store, key, &options).unwrap_or_else(|refusal| {
            if let Some((file, reason)) = refusal {
                store.refuse(&file, &mesh(), &reason);
            }
            Saved::Nothing
        })
    }

    /// The tree that was restored, or the file that has none and why. There may be no file.
    fn find_restored(store: &Store, key: &TreeKey, options: &BuildOptions) -> Result<Saved, Option<(String, String)>> {
        let State { restored, .. } = &mut *store.lock();
        let of_mesh = restored.get_mut(&key.mesh).ok_or(None)?;
        let file = of_mesh.first().ok_or(None)?.file.clone();
        let Some(place) = of_mesh.iter().position(|tree| tree.joints == key.joints) else {
            let joints = match key.joints {
                Some(joints) => format!("a skeleton of {joints} joints"),
                None => "no skeleton".to_owned(),
            };
            let reason = format!("it has no tree for {joints}. `morph-collide bake` writes it anew");
            return Err(Some((file, reason)));
        };
        let found = of_mesh.swap_remove(place);
        if found.options != *options {
            return Err(Some((file, other_options(&found.options, options))));
        }
        Ok(Saved::Tree(found.tree))
    }

    /// Logs why files are not used.
    pub(in crate::import) fn log(&self) {
        let warnings = self
            .store
            .iter()
            .flat_map(|store| std::mem::take(&mut store.lock().warnings));
        warnings.for_each(|warning| warn!("{warning}"));
    }

    /// A mesh was changed after it was loaded, or is gone.
    pub(in crate::import) fn forget(&self, mesh: AssetId<Mesh>) {
        if let Some(store) = &self.store {
            store.lock().restored.remove(&mesh);
        }
    }
}
