//! Files of trees as assets.

use std::io;
use std::sync::Arc;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, LoadContext};
use bevy::prelude::*;
use morph_collision::{SavedTree, TreeFile, TreeFileError};
use thiserror::Error;

/// How the name of a file of trees ends, after the whole name of its model.
pub(super) const EXTENSION: &str = "morphtree";

/// The trees of a model's meshes, which `morph-collide bake` saved. Bevy loads it from `*.morphtree` if
/// [`MorphTreeFilesPlugin`](super::MorphTreeFilesPlugin) is in the app.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct MorphTreeFile(pub(super) Arc<TreeFile>);

impl From<TreeFile> for MorphTreeFile {
    fn from(file: TreeFile) -> Self {
        Self(Arc::new(file))
    }
}

impl MorphTreeFile {
    /// The trees.
    #[must_use]
    pub fn trees(&self) -> &[SavedTree] {
        &self.0.trees
    }
}

/// Takes the trees of the meshes at and below this entity from a file, wherever the file and the meshes come from.
///
/// A tree that is requested waits until the file is loaded. If that fails, or no tree in the file fits the mesh, the log says so, and the tree
/// is built. Needs [`MorphTreeFilesPlugin`](super::MorphTreeFilesPlugin). You do not need it for files beside models.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     commands.spawn((
///         WorldAssetRoot(assets.load("boss.glb#Scene0")),
///         MorphColliderScene::default(),
///         MorphTreeFrom(assets.load("trees/boss.morphtree")),
///     ));
/// }
/// # App::new().add_systems(Startup, spawn);
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphTreeFrom(pub Handle<MorphTreeFile>);

/// Why a file of trees cannot be loaded.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MorphTreeFileError {
    /// It cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It has something else in it.
    #[error("{0}; `morph-collide bake` writes it anew")]
    Content(#[from] TreeFileError),
}

#[derive(TypePath, Default)]
pub(super) struct Loader;

impl AssetLoader for Loader {
    type Asset = MorphTreeFile;
    type Settings = ();
    type Error = MorphTreeFileError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &Self::Settings,
        _: &mut LoadContext<'_>,
    ) -> Result<MorphTreeFile, MorphTreeFileError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(TreeFile::from_bytes(&bytes)?.into())
    }

    fn extensions(&self) -> &[&str] {
        &[EXTENSION]
    }
}
