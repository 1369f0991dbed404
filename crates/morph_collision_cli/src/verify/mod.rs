//! `morph-collide verify`: compares a model's answers with brute force.

mod report;

use std::path::{Path, PathBuf};

use clap::Args;
use morph_collision::BuildOptions;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::rivals::SetUpError;
use morph_collision_testkit::verify::{LEAF_SIZES, Trees, verify as compare, verify_motion};

use crate::error::CliError;
use crate::model_file::{FileArgs, count_memory, read_clips};
use crate::progress::ProgressArgs;
use crate::{Verdict, output};
use report::{VerifyReport, WhichMesh};

/// Compare the answers of trees about two bodies with brute force in exact arithmetic.
///
/// Two bodies, of one mesh or of two, take shapes from the mesh's own clips and at random (convex, signed, above one, twelve in
/// sum, one-hot, zero). Their placements are turned, stretched, mirrored and sheared, from far apart to deep inside each other;
/// some nearly touch, found by bisection down to neighbouring floating-point numbers. Every frame compares all intersecting pairs
/// of triangles, and checks all boxes against the vertices below them. Then bodies move from one such situation to another, and
/// samples of what touches on the way are compared with exact arithmetic.
///
/// The exit code is 1 if anything differs. The smallest pair of triangles or vertex that differs is printed.
#[derive(Debug, Args)]
pub(crate) struct VerifyArgs {
    /// A .glb or .gltf file.
    model: PathBuf,
    /// Another .glb or .gltf file for the second body; by default it is the same mesh.
    model2: Option<PathBuf>,
    /// The mesh's index in the first file.
    #[arg(long, value_name = "N", default_value_t = 0)]
    mesh: usize,
    /// The mesh's index in the second file.
    #[arg(long, value_name = "N", default_value_t = 0, requires = "model2")]
    mesh2: usize,
    /// Number of situations to compare.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..))]
    frames: u64,
    /// Random seed; the same seed gives the same situations.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Most triangles in a leaf of the trees, 1 to 255; by default, trees of several leaf sizes are compared.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    leaf: Option<u8>,
    #[command(flatten)]
    files: FileArgs,
    #[command(flatten)]
    progress: ProgressArgs,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    json: bool,
}

/// Motions are compared for this share of the situations.
const FRAMES_PER_STEP: u64 = 4;

/// Draws situations, compares the answers, and reports differences.
pub(crate) fn verify(args: &VerifyArgs) -> Result<Verdict, CliError> {
    let mesh = args.read(&args.model, args.mesh, "--mesh")?;
    let second = args
        .model2
        .as_ref()
        .map(|model| args.read(model, args.mesh2, "--mesh2"));
    let second = second.transpose()?;
    let meshes = [&mesh, second.as_ref().unwrap_or(&mesh)];
    let which = which_meshes(args);

    let leaf_sizes = args.leaf_sizes();
    let mut sources = Vec::new();
    for &leaf_size in &leaf_sizes {
        let options = BuildOptions::default()
            .with_leaf_size(leaf_size)
            .map_err(SetUpError::from);
        let trees = options.and_then(|options| Trees::build(meshes, &options));
        sources.push(trees.map_err(|error| blame(error, &which, meshes))?);
    }
    let refused = |reason| CliError::Situation {
        file: args.model.clone(),
        mesh: args.mesh,
        name: mesh.name.clone(),
        reason,
    };
    let bar = args.progress.start("frame", args.frames);
    let verification = compare(meshes, &mut sources, args.frames, args.seed, || bar.step());
    bar.finish();
    let verification = verification.map_err(refused)?;
    let steps = args.frames.div_ceil(FRAMES_PER_STEP);
    let bar = args.progress.start("step", steps);
    let motion = verify_motion(meshes, &mut sources, steps, args.seed, || bar.step());
    bar.finish();
    let motion = motion.map_err(refused)?;

    let report = VerifyReport::new(which, &leaf_sizes, args.seed, &verification, motion);
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text())?;
    }
    Ok(report.verdict())
}

impl VerifyArgs {
    fn leaf_sizes(&self) -> Vec<usize> {
        self.leaf.map_or(LEAF_SIZES.to_vec(), |leaf| vec![usize::from(leaf)])
    }

    /// Reads a mesh with its clips and counts the memory of its trees.
    fn read(&self, model: &Path, index: usize, flag: &'static str) -> Result<MorphMesh, CliError> {
        let (file, mut mesh) = self.files.open_mesh(model, index, flag)?;
        let trees = self.leaf_sizes().len() as u64 * mesh.tree_bytes();
        count_memory(&file, index, trees, || "its trees".into())?;
        read_clips(&file, index, &mut mesh)?;
        Ok(mesh)
    }
}

fn which_meshes(args: &VerifyArgs) -> [WhichMesh; 2] {
    let first = WhichMesh {
        model: args.model.clone(),
        mesh: args.mesh,
    };
    let second = args.model2.as_ref().map(|model| WhichMesh {
        model: model.clone(),
        mesh: args.mesh2,
    });
    [first.clone(), second.unwrap_or(first)]
}

/// Names the file and index of the refused mesh.
fn blame(error: SetUpError, which: &[WhichMesh; 2], meshes: [&MorphMesh; 2]) -> CliError {
    match error {
        SetUpError::Model { mesh, reason } => CliError::Mesh {
            file: which[mesh].model.clone(),
            mesh: which[mesh].mesh,
            name: meshes[mesh].name.clone(),
            reason: reason.into(),
        },
        other => CliError::SetUp(other),
    }
}
