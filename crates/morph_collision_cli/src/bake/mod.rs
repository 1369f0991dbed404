//! `morph-collide bake`: writes the trees of a model's meshes to a file that a game ships beside the model.
//!
//! `trees` makes the trees.

mod trees;

use std::path::{Path, PathBuf};

use clap::Args;
use morph_collision_models::memory::Bytes;
use morph_collision_models::text::Grouped;
use serde::Serialize;

use crate::error::CliError;
use crate::files::model::{FileArgs, STANDARD};
use crate::messages::{complain, counted};
use crate::options::tree::TreeArgs;
use crate::output;
use crate::output::file::OutputFile;

pub use trees::{BakeOptions, Baked, NotBaked, Trees};

const EXAMPLES: &str = "Examples:
  morph-collide bake character.glb
  morph-collide bake level.glb --rigid --output assets/level.glb.morphtree
  morph-collide bake face.glb --certificates";

/// Write the trees of a model's meshes to a file, so that a game need not build them when it loads the model.
///
/// The Bevy plugin `MorphTreeFilesPlugin` uses it if it is beside the model under the model's whole name, as in character.glb.morphtree. It has a
/// tree for each primitive that targets or joints deform. If the model changes, bake it again: the game notices, says so, and builds the trees
/// as it does without the file.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BakeArgs {
    /// A .glb or .gltf file; - reads a .glb from standard input.
    model: PathBuf,
    /// The file to write; MODEL.morphtree by default. - is standard output.
    #[arg(long, short, value_name = "OUT")]
    output: Option<PathBuf>,
    /// Bake meshes that nothing deforms, too.
    #[arg(long)]
    rigid: bool,
    /// Store which triangles never touch each other for weights from 0 to 1, which makes looking for self-collisions faster. Skinned meshes have
    /// no such certificates. The proof can take minutes.
    #[arg(long)]
    certificates: bool,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of a summary.
    #[arg(long)]
    json: bool,
}

/// The JSON of `bake`.
#[derive(Debug, Serialize)]
struct BakeReport {
    file: String,
    bytes: usize,
    trees: Vec<Baked>,
    not_baked: Vec<NotBaked>,
}

/// Builds the trees and writes them.
pub(crate) fn bake(args: &BakeArgs) -> Result<(), CliError> {
    let path = args.output()?;
    let file = args.files.open(&args.model)?;
    if file.skips_bad() {
        return Err(CliError::Flag {
            flag: "--skip-bad",
            reason: "only meshes without bad triangles can be baked".to_owned(),
        });
    }
    let output = OutputFile::create("--output", &path, file.files())?;
    let options = BakeOptions {
        rigid: args.rigid,
        certificates: args.certificates,
        tree: args.tree.build(),
    };
    let Trees {
        file: trees,
        baked,
        not_baked,
    } = Trees::bake(&file, &options);
    for NotBaked { label, reason } in &not_baked {
        complain(format_args!(
            "warning: {}#{label} is not baked: {reason}",
            args.model.display()
        ));
    }
    if baked.is_empty() {
        let reason = "it has no mesh to bake; --rigid bakes meshes that nothing deforms, too".to_owned();
        return Err(CliError::NoUsableMesh {
            file: args.model.clone(),
            reason,
        });
    }
    let bytes = trees.to_bytes();
    output.write(|out| out.write_all(&bytes))?;
    let report = BakeReport {
        file: path.display().to_string(),
        bytes: bytes.len(),
        trees: baked,
        not_baked,
    };
    if args.json {
        return output::print_json(&report);
    }
    let triangles: usize = report.trees.iter().map(|tree| tree.triangles).sum();
    output::print(&format!(
        "{}: {} of {} triangles in all, {}\n",
        report.file,
        counted(report.trees.len(), "tree", "trees"),
        Grouped(triangles as u64),
        Bytes(report.bytes as u64)
    ))
}

impl BakeArgs {
    fn output(&self) -> Result<PathBuf, CliError> {
        match &self.output {
            Some(output) => Ok(output.clone()),
            None if self.model == Path::new(STANDARD) => Err(CliError::Flag {
                flag: "--output",
                reason: "a model from standard input has no name; give the file to write".to_owned(),
            }),
            None => {
                let mut name = self.model.clone().into_os_string();
                name.push(".morphtree");
                Ok(name.into())
            }
        }
    }
}
