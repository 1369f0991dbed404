//! The meshes of a model to try, and what is said if one does not allow a shape.

use morph_collision_testkit::gltf_read::GltfFile;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::rivals::PoseError;

use super::LintArgs;
use super::poses::Tried;
use crate::error::CliError;
use crate::model_file::{read_clips, read_mesh};
use crate::output;

/// The meshes to try, with their indices. Without `--mesh`, meshes that cannot collide are left out with a warning.
pub(super) fn meshes(args: &LintArgs, file: &GltfFile) -> Result<Vec<(usize, MorphMesh)>, CliError> {
    let indices = match &args.mesh {
        Some(choice) => {
            let found = choice.find(file);
            vec![found.map_err(|reason| CliError::Flag { flag: "--mesh", reason })?]
        }
        None => (0..file.mesh_count()).collect(),
    };
    let mut meshes = Vec::new();
    for index in indices {
        let mut mesh = match read_mesh(file, index) {
            Ok(mesh) => mesh,
            Err(error) if args.mesh.is_some() => return Err(error),
            Err(error) => {
                output::complain(format_args!("warning: left out: {error}"));
                continue;
            }
        };
        mesh.default_weights = file.default_weights(index, None, mesh.targets.len())?;
        read_clips(file, index, &mut mesh)?;
        meshes.push((index, mesh));
    }
    if meshes.is_empty() {
        return Err(CliError::NoUsableMesh {
            file: args.model.clone(),
            reason: "it has no mesh that can collide".to_owned(),
        });
    }
    Ok(meshes)
}

/// A shape in a message.
pub(super) fn shape_words(shape: &Tried, mesh: &MorphMesh) -> String {
    let source = shape.source.words(&mesh.target_names);
    match shape.moment {
        Some(moment) => format!("{source} at {moment}"),
        None => source,
    }
}

/// The error for a shape that the mesh does not allow.
pub(super) fn refused(args: &LintArgs, index: usize, mesh: &MorphMesh, shape: String, reason: PoseError) -> CliError {
    CliError::Shape {
        file: args.model.clone(),
        mesh: index,
        name: mesh.name.clone(),
        shape,
        reason: Box::new(reason),
    }
}
