//! Files of trees as assets.

use std::io;
use std::sync::Arc;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, AsyncReadExt, LoadContext};
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use morph_collision::{SavedTree, TreeFile, TreeFileError};
use thiserror::Error;

/// How the name of a file of trees ends, after the whole name of its model.
pub(super) const EXTENSION: &str = "morphtree";
/// Longer files are refused: a tree takes about three bytes per triangle, and reading a file takes up to 32 times its length, so
/// a gibibyte.
pub(super) const MOST_BYTES: usize = 32 << 20;
/// The bytes that are read at once.
const PIECE: usize = 64 << 10;

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
    /// It is longer than files of trees may be.
    #[error("it has more than {most} bytes, which is too much for a file of trees")]
    TooLong {
        /// The limit in bytes.
        most: usize,
    },
    /// Two trees are of the same mesh, with skeletons of as many joints.
    #[error("it has two trees of the mesh `{label}`; `morph-collide bake` writes it anew")]
    Repeated {
        /// The mesh.
        label: String,
    },
}

/// Reads a file that is no longer than it may be, and that has each tree once.
pub(super) fn decoded(bytes: &[u8]) -> Result<TreeFile, MorphTreeFileError> {
    let most = MOST_BYTES;
    if bytes.len() > most {
        return Err(MorphTreeFileError::TooLong { most });
    }
    let file = TreeFile::from_bytes(bytes)?;
    let mut seen = HashSet::new();
    let repeated = file
        .trees
        .iter()
        .find(|saved| !seen.insert((&saved.label, saved.joints)));
    let repeated = repeated.map(|saved| saved.label.clone());
    drop(seen);
    match repeated {
        Some(label) => Err(MorphTreeFileError::Repeated { label }),
        None => Ok(file),
    }
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
        let (mut bytes, mut piece) = (Vec::new(), vec![0; PIECE]);
        // A file that is too long is not read to its end.
        while bytes.len() <= MOST_BYTES {
            let read = reader.read(&mut piece).await?;
            if read == 0 {
                break;
            }
            bytes.extend_from_slice(&piece[..read]);
        }
        Ok(decoded(&bytes)?.into())
    }

    fn extensions(&self) -> &[&str] {
        &[EXTENSION]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_too_long_is_refused() {
        let error = decoded(&vec![0; MOST_BYTES + 1]).unwrap_err().to_string();
        assert!(error.contains("more than 33554432 bytes"), "{error}");
        let error = decoded(&vec![0; MOST_BYTES]).unwrap_err().to_string();
        assert!(error.contains("not a file of trees"), "{error}");
    }
}
