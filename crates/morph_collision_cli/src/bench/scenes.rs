//! What is measured: the paper's scenes or a scene per model.

use std::path::Path;

use morph_collision_testkit::bench::Experiment;
use morph_collision_testkit::gltf_read::read_meshes;

use super::BenchArgs;
use crate::error::CliError;

/// An experiment, and how errors speak of it.
pub(super) struct BenchScene {
    pub(super) experiment: Experiment,
    /// The model's file, or the scene's name.
    pub(super) origin: String,
}

/// The scenes that the flags name.
pub(super) fn scenes(args: &BenchArgs) -> Result<Vec<BenchScene>, CliError> {
    let every = usize::from(args.every);
    let names: Vec<String> = if args.models.is_empty() {
        Experiment::paper_names().iter().map(ToString::to_string).collect()
    } else {
        args.models.iter().map(|model| name_of(model)).collect()
    };
    if let Some(unknown) = args.scenes.iter().find(|name| !names.contains(name)) {
        return Err(CliError::Flag {
            flag: "--scene",
            reason: format!("there is no scene '{unknown}', expected one of: {}", names.join(", ")),
        });
    }
    let wanted = |name: &String| args.scenes.is_empty() || args.scenes.contains(name);
    if args.models.is_empty() {
        let of_name = |name: String| {
            Experiment::of_paper(&name, every).map(|experiment| BenchScene {
                experiment,
                origin: name,
            })
        };
        return Ok(names.into_iter().filter(wanted).filter_map(of_name).collect());
    }
    let chosen = args.models.iter().zip(names).filter(|(_, name)| wanted(name));
    chosen
        .map(|(model, name)| of_model(model, name, usize::from(args.bodies), every))
        .collect()
}

fn name_of(model: &Path) -> String {
    model.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn of_model(model: &Path, name: String, bodies: usize, every: usize) -> Result<BenchScene, CliError> {
    let meshes = read_meshes(model)?;
    let largest = meshes.into_iter().max_by_key(|mesh| mesh.triangles.len());
    let mesh = largest.ok_or_else(|| CliError::NoUsableMesh {
        file: model.into(),
        reason: "it has none".to_owned(),
    })?;
    Ok(BenchScene {
        experiment: Experiment::of_model(name, mesh, bodies, every),
        origin: model.display().to_string(),
    })
}
