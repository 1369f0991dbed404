//! Reads the meshes of a glTF 2.0 file (`.gltf` or `.glb`) with their morph targets, skins and animations.
//!
//! The order of the work is the order of the files: open a file (`file`), take the JSON out of its container (`container`, `document`), fetch a
//! buffer when it is first used (`buffers`, `uri`), open and decode accessors (`accessor`), put primitives together to a mesh (`mesh`, `primitive`,
//! `triangles`), read what moves it (`skin`, `influences`) and collect the clips (`animation`, `joint_animation`).
//!
//! Files come from anywhere. Every index is checked where it is used, and nothing is checked that is not used: a file with a broken
//! texture, a broken second mesh or a missing buffer that no mesh needs still has its first mesh. Whatever is allocated is counted
//! against the file's [`MemoryBudget`](crate::memory::MemoryBudget) first. Buffers in other files have to be regular files in the directory of the model or below
//! ([`ReadOptions::any_path`] lifts that). Images are never decoded. Transforms of nodes that show a mesh are not applied: a mesh is read in
//! its own space. Default weights are ignored.

mod accessor;
mod animation;
mod buffers;
mod container;
mod document;
mod error;
mod file;
mod influences;
mod joint_animation;
mod mesh;
mod primitive;
mod skin;
mod triangles;
mod uri;

use std::path::Path;

pub use self::animation::Clips;
pub use self::document::ElementError;
pub use self::error::{
    AccessorProblem, AnimationProblem, BufferFault, BufferProblem, MeshProblem, ReadError, Remedy, SkinProblem,
};
pub use self::file::{GltfFile, ReadOptions};
pub use self::joint_animation::JointClips;
pub use self::mesh::FoundMesh;

use crate::mesh::MorphMesh;

/// Reads every mesh of a file, in file order, as [`GltfFile::mesh`] does, with its clips, its skin and with every target in full.
///
/// Clips that cannot be played are left out; [`GltfFile::clips`] and [`GltfFile::joint_clips`] say why.
///
/// # Errors
/// [`ReadError`] names the file, and the mesh, primitive and accessor at fault. A mesh whose skin is broken is an error.
pub fn read_meshes(path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    GltfFile::open(path, &ReadOptions::default())?.all_meshes()
}

/// As [`read_meshes`] from a file's bytes; buffers must be within them. `path` is only for messages.
///
/// # Errors
/// As [`read_meshes`].
pub fn parse_meshes(bytes: &[u8], path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    GltfFile::parse(bytes, path, &ReadOptions::default())?.all_meshes()
}
