//! Trees that `morph-collide bake` saved: restored instead of built.
//!
//! - `file`: [`MorphTreeFile`], its asset loader, and [`MorphTreeFrom`], which names a file.
//! - `beside`: while Bevy loads a glTF file, restores the trees of its meshes from the file beside it.
//! - `find`: what was saved of a requested tree. `fit`: which of the saved trees fits a mesh, or why none does.
//! - `store`: what loaders and tasks leave for the systems.
//! - `plugin`: [`MorphTreeFilesPlugin`].

#[cfg(feature = "gltf")]
mod beside;
mod file;
mod find;
mod fit;
mod plugin;
mod store;

pub use file::{MorphTreeFile, MorphTreeFileError, MorphTreeFrom};
pub(super) use find::Saved;
pub(crate) use find::SavedTrees;
pub(super) use fit::Layouts;
pub use plugin::MorphTreeFilesPlugin;
pub(super) use store::Restoring;
