//! `morph-collide inspect`: what a model is made of, and what tree it gets.

use std::path::PathBuf;

use clap::Args;
use morph_collision_testkit::inspect::FileReport;

use crate::error::CliError;
use crate::model_file::FileArgs;
use crate::output;

/// Show the meshes of a glTF file: sizes, targets, ranges of animated weights, and the tree each mesh gets.
///
/// Broken meshes are listed with their error. The exit code is 2 if no mesh can collide.
#[derive(Debug, Args)]
pub(crate) struct InspectArgs {
    /// A .glb or .gltf file.
    model: PathBuf,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
}

/// Reports every mesh of the file. An unusable mesh is shown with its error; it is an error only if all meshes are
/// unusable.
pub(crate) fn inspect(args: &InspectArgs) -> Result<(), CliError> {
    let file = args.files.open(&args.model)?;
    let report = FileReport::read(&file);
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.to_string())?;
    }
    match report.why_unusable() {
        Some(reason) => Err(CliError::NoUsableMesh {
            file: args.model.clone(),
            reason,
        }),
        None => Ok(()),
    }
}
