//! `morph-collide inspect`: what models are made of, and what tree each mesh gets.

use std::path::{Path, PathBuf};

use clap::Args;
use morph_collision_models::inspect::{FileReport, Summary, SummaryRow};

use crate::error::CliError;
use crate::files::model::{FileArgs, MeshChoice};
use crate::messages;
use crate::messages::progress;
use crate::output;

const EXAMPLES: &str = "Examples:
  morph-collide inspect face.glb
  morph-collide inspect character.glb --mesh Body
  morph-collide inspect models/*.glb";

/// Show what glTF files contain: animations, and for each mesh its size, bounds, nodes, skin, targets and tree.
///
/// `reach` is how far a target moves a vertex at weight 1, and `unmoved` is the share of vertices that it does not move. Bounds are
/// those of the rest pose. Several files get one line each, and so do the meshes of a file with more than four.
///
/// Broken meshes are listed with their error. The exit code is 2 if a file has no mesh that can collide.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct InspectArgs {
    /// .glb or .gltf files; - reads a .glb from standard input.
    #[arg(required = true)]
    models: Vec<PathBuf>,
    /// Show only this mesh, in full: its index in the file, or its name.
    #[arg(long, value_name = "MESH")]
    mesh: Option<MeshChoice>,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
}

/// Reports every mesh of the files. An unusable mesh is shown with its error; it is an error only if all meshes of a file are
/// unusable.
pub(crate) fn inspect(args: &InspectArgs) -> Result<(), CliError> {
    let [model] = &args.models[..] else {
        return batch(args);
    };
    let report = report(args, model)?;
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.to_string())?;
    }
    match report.why_unusable() {
        Some(reason) => Err(CliError::NoUsableMesh {
            file: model.clone(),
            reason,
        }),
        None => Ok(()),
    }
}

/// One line per file, and totals.
fn batch(args: &InspectArgs) -> Result<(), CliError> {
    if args.mesh.is_some() {
        let reason = "works only with one file".to_owned();
        return Err(CliError::Flag { flag: "--mesh", reason });
    }
    let mut summary = Summary::default();
    for model in &args.models {
        summary.files.push(match report(args, model) {
            Ok(report) => {
                for mesh in &report.meshes {
                    if let Some(left_out) = &mesh.left_out {
                        messages::warn_left_out(model, mesh.index, &mesh.name, left_out.clone());
                    }
                }
                SummaryRow::of(&report)
            }
            Err(error) => SummaryRow::unreadable(model.display().to_string(), error.to_string()),
        });
    }
    if args.json {
        output::print_json(&summary)?;
    } else {
        output::print(&summary.to_string())?;
    }
    let failed = summary.files.iter().filter(|row| row.usable == 0).count();
    match failed {
        0 => Ok(()),
        _ => Err(CliError::Batch {
            failed,
            all: summary.files.len(),
        }),
    }
}

fn report(args: &InspectArgs, model: &Path) -> Result<FileReport, CliError> {
    let file = args.files.open(model)?;
    let only = args.mesh.as_ref().map(|mesh| mesh.find(&file)).transpose();
    let only = only.map_err(|reason| CliError::Flag { flag: "--mesh", reason })?;
    let count = file.mesh_count();
    let meshes = only.map_or(0..count, |mesh| mesh..mesh + 1);
    let show = |mesh| progress::doing(format!("{}: mesh {mesh} of {count} and its tree", model.display()));
    Ok(FileReport::read_meshes(&file, meshes, show))
}
