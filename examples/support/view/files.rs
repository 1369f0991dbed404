//! Files that are not on a disk: files that users provide, and all files in a browser.

use std::path::Path;

use bevy::asset::io::memory::{Dir, MemoryAssetReader};
use bevy::asset::io::{AssetSourceBuilder, AssetSourceId};
use bevy::prelude::*;

/// The files, kept in memory. Clones share the same files.
#[derive(Resource, Clone, Debug, Default)]
pub struct Files(Dir);

/// The asset source of the files: `brought://name`.
const SOURCE: &str = "brought";

impl Files {
    /// Adds a file, or replaces the one of that name.
    pub fn insert(&self, path: &Path, bytes: Vec<u8>) {
        self.0.insert_asset(path, bytes);
    }

    /// Removes a file.
    pub fn remove(&self, path: &Path) {
        self.0.remove_asset(path);
    }

    /// An asset path for an inserted file.
    #[must_use]
    pub fn asset_path(path: &str) -> String {
        format!("{SOURCE}://{path}")
    }

    /// Registers the files as asset sources. Must be called before the asset server is added.
    pub(super) fn serve(&self, app: &mut App) {
        let ids = [
            Some(AssetSourceId::from(SOURCE)),
            // A web page has no folder. It fetches what it needs beforehand.
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
