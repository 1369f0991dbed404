//! Reads the meshes of a glTF 2.0 file (`.gltf` or `.glb`) with their morph targets and weight animations.
//!
//! The order of the work is the order of the files: open the container and fetch its buffers (`container`), decode
//! accessors (`accessor`), put primitives together (`primitive`, `triangles`) and collect the clips (`animation`).
//!
//! Files come from anywhere, so every index is checked where it is used, and nothing is checked that is not used: a file
//! with a broken texture still has a mesh. Images are never decoded. Node transforms are not applied: a mesh is read in
//! its own space. Skins and default weights are ignored.

mod accessor;
mod animation;
mod container;
mod error;
mod primitive;
mod triangles;

use std::path::Path;

use gltf::json;

pub use self::error::{AccessorProblem, AnimationProblem, MeshProblem, ReadError};
use self::{accessor::Accessors, container::Container};
use crate::mesh::MorphMesh;

/// Reads every mesh of a file, in file order.
///
/// Several primitives become one mesh: their vertices are joined (once, where primitives share them) and their triangles
/// numbered through; strips and fans become triangles of the same winding; points and lines give an empty range. A mesh
/// without triangles or without targets is returned as it is.
///
/// # Errors
/// [`ReadError`] names the file, and the mesh, primitive and accessor, or the animation, that is at fault.
pub fn read_meshes(path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    meshes_of(&Container::open(path)?, path)
}

/// As [`read_meshes`] from a file's bytes; buffers must be within them. `path` is only for messages.
///
/// # Errors
/// As [`read_meshes`].
pub fn parse_meshes(bytes: &[u8], path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    meshes_of(&Container::parse(bytes, path, None)?, path)
}

fn meshes_of(container: &Container, path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    let accessors = Accessors::new(container.root(), container.buffers());
    let mut meshes = Vec::new();
    for (index, mesh) in container.root().meshes.iter().enumerate() {
        let name = mesh.name.clone().unwrap_or_else(|| format!("mesh_{index}"));
        let mut read = primitive::read(mesh, &accessors).map_err(|problem| ReadError::Mesh {
            path: path.to_owned(),
            mesh: index,
            name: name.clone(),
            problem: Box::new(problem),
        })?;
        read.name = name;
        read.target_names = target_names(mesh, read.targets.len());
        meshes.push(read);
    }
    animation::read(container.root(), &accessors, &mut meshes).map_err(|(animation, name, problem)| {
        ReadError::Animation {
            path: path.to_owned(),
            animation,
            name,
            problem: Box::new(problem),
        }
    })?;
    Ok(meshes)
}

/// The names that most exporters put into the mesh's extras, made up where they are missing.
fn target_names(mesh: &json::Mesh, count: usize) -> Vec<String> {
    #[derive(serde::Deserialize)]
    struct Extras {
        #[serde(rename = "targetNames")]
        target_names: Vec<String>,
    }
    let mut names = mesh
        .extras
        .as_ref()
        .and_then(|extras| serde_json::from_str::<Extras>(extras.get()).ok())
        .map(|extras| extras.target_names)
        .unwrap_or_default();
    names.truncate(count);
    names.extend((names.len()..count).map(|target| format!("target_{target}")));
    names
}
