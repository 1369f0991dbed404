//! Triangle meshes with morph targets, clips and skins, as files store them: not welded and not validated.
//!
//! - [`MorphMesh`], [`MeshSkin`]: a mesh, and how joints move it.
//! - [`MorphMesh::joined`]: two meshes as one, such as a garment and the body that wears it.
//! - [`Together`]: all meshes of a character as one.
//! - [`Unweighted`]: the vertices that no joint moves, which can be left out.

mod joined;
mod morph_mesh;
mod skin;
mod together;
mod unweighted;

pub use joined::JoinError;
pub use morph_mesh::MorphMesh;
pub use skin::{InfluenceSet, MeshSkin};
pub use together::{Together, TogetherError};
pub use unweighted::Unweighted;
