//! One mesh of a model file, as flags name it.

use std::path::Path;

use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;

use crate::error::CliError;

/// Reads the mesh `mesh`, which `flag` gave, of a glTF file.
pub(crate) fn read_mesh(model: &Path, mesh: usize, flag: &'static str) -> Result<MorphMesh, CliError> {
    let mut meshes = read_meshes(model)?;
    if mesh >= meshes.len() {
        return Err(CliError::Flag {
            flag,
            reason: format!("{} has no mesh {mesh}, only {}", model.display(), meshes.len()),
        });
    }
    Ok(meshes.swap_remove(mesh))
}
