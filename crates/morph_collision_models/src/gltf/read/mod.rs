//! Reads the meshes of a glTF 2.0 file (`.gltf` or `.glb`) with their morph targets, skins and animations.
//!
//! The steps, and the files that implement them:
//!
//! 1. Open a file (`file`) and take the JSON out of its container (`container`, `lfs`), parsed in parts (`document`,
//!    `attributes`, `list`, `integers`).
//! 2. Load a buffer when it is first used (`buffers`, `uri`), decode compressed views and primitives (`view`, `compressed`, `meshopt`,
//!    `draco`), and open and decode accessors (`accessor`).
//! 3. Assemble primitives into a mesh (`mesh`, `primitive`, `triangles`, `target_names`), without its bad parts if asked (`skipped`); or take
//!    one of them alone (`part`).
//! 4. Find what a scene draws: nodes with their mesh and their skin, once for each instance (`scenes`, `nodes`, `instances`).
//! 5. Read the skin with which a node shows a mesh (`skin`, `influences`), and the clips that move it (`channels`, `animation_list`,
//!    `weight_animation`, `joint_animation`).
//! 6. Read the named expressions of avatars (`expressions`).
//!
//! Files may come from anywhere:
//!
//! - Every index is checked when it is used, and unused data is not checked. A file with a broken texture, a broken second mesh
//!   or a missing buffer that no mesh needs still gives its first mesh.
//! - Every allocation is first counted against the file's [`MemoryBudget`](crate::memory::MemoryBudget).
//! - Buffers in other files have to be regular files in the directory of the model or below ([`ReadOptions::any_path`] lifts
//!   that).
//!
//! Images are never decoded. Transforms of nodes that show a mesh are not applied: a mesh is read in its own space, and
//! [`GltfFile::placement`] says where a node puts it.
//!
//! Compressed geometry is decoded wherever it is. [`GltfFile::extension_notes`] says which other extensions are not applied. Files
//! that require an unknown one are refused (`extensions`).

mod accessor;
mod animation_list;
mod attributes;
mod borrowed;
mod buffers;
mod channels;
mod compressed;
mod container;
mod document;
mod draco;
mod error;
mod expressions;
mod extensions;
mod file;
mod influences;
mod instances;
mod integers;
mod joint_animation;
mod lfs;
mod list;
mod mesh;
mod meshopt;
mod nodes;
mod part;
mod primitive;
mod roots;
mod scenes;
mod skin;
mod skipped;
mod target_names;
mod triangles;
mod uri;
mod view;
mod weight_animation;

use std::path::Path;

pub use self::animation_list::AnimationInfo;
pub use self::borrowed::{BorrowedClip, Matched};
pub use self::document::ElementError;
pub use self::error::{
    AccessorProblem, AnimationProblem, BufferFault, BufferProblem, CompressionFault, MeshProblem, NodeProblem,
    ReadError, Remedy, SkinProblem,
};
pub use self::expressions::{Expression, ExpressionBind};
pub use self::file::{GltfFile, ReadOptions};
pub use self::joint_animation::JointClips;
pub use self::lfs::{LFS_POINTER, is_lfs_pointer};
pub use self::mesh::FoundMesh;
pub use self::part::Part;
pub use self::roots::Trees;
pub use self::scenes::{Drawing, DrawnMesh, Extent};
pub use self::skipped::Skipped;
pub use self::weight_animation::Clips;

use crate::mesh::MorphMesh;

/// Reads every mesh of a file, in file order, like [`GltfFile::mesh`], with its clips and its skin. All targets are stored in
/// full.
///
/// Clips that cannot be played are left out; [`GltfFile::clips`] and [`GltfFile::joint_clips`] say why.
///
/// # Errors
/// [`ReadError`] names the file, and the mesh, primitive and accessor at fault. A mesh with a broken skin is an error.
pub fn read_meshes(path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    GltfFile::open(path, &ReadOptions::default())?.all_meshes()
}

/// Like [`read_meshes`], from a file's bytes. Buffers must be within them. `path` is only for messages.
///
/// # Errors
/// See [`read_meshes`].
pub fn parse_meshes(bytes: &[u8], path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    GltfFile::parse(bytes, path, &ReadOptions::default())?.all_meshes()
}
