//! Files that do not lie on a disk: those that a user brings, and in a browser all.

use std::path::Path;

use bevy::asset::io::memory::{Dir, MemoryAssetReader};
use bevy::asset::io::{AssetSourceBuilder, AssetSourceId};
use bevy::prelude::*;

/// The files, kept in memory. Clones are of the same ones.
#[derive(Resource, Clone, Debug, Default)]
pub struct Files(Dir);

/// What the asset server knows them by: `brought://name`.
const SOURCE: &str = "brought";

impl Files {
    /// Adds a file, or another one of that name.
    pub fn insert(&self, path: &Path, bytes: Vec<u8>) {
        self.0.insert_asset(path, bytes);
    }

    /// Forgets a file.
    pub fn remove(&self, path: &Path) {
        self.0.remove_asset(path);
    }

    /// An asset path for a file that was inserted.
    #[must_use]
    pub fn asset_path(path: &str) -> String {
        format!("{SOURCE}://{path}")
    }

    /// Makes them known to an asset server that comes later.
    pub(super) fn serve(&self, app: &mut App) {
        let ids = [
            Some(AssetSourceId::from(SOURCE)),
            // A page has no folder: what it needs it fetches itself, beforehand.
            cfg!(target_arch = "wasm32").then_some(AssetSourceId::Default),
        ];
        for id in ids.into_iter().flatten() {
            let root = self.0.clone();
            let reader = move || -> Box<dyn bevy::asset::io::ErasedAssetReader> {
                Box::new(MemoryAssetReader { root: root.clone() })
            };
            app.register_asset_source(id, AssetSourceBuilder::new(reader));
        }
        app.insert_resource(self.clone());
    }
}
