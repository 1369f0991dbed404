//! `morph-lab verify`: compares a model's answers with brute force.

mod batch;
mod report;

use std::path::{Path, PathBuf};

use clap::Args;
use morph_collision::BuildOptions;
use morph_collision_cli::shared::{
    AnyError, CliError, FileArgs, MeshChoice, Verdict, count, count_memory, doing, leave_out_unweighted, print,
    print_json, read_clips,
};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::rivals::SetUpError;
use morph_collision_testkit::verify::{LEAF_SIZES, Trees, verify as compare, verify_motion};

use crate::error::LabError;
use batch::BatchReport;
use report::{VerifyReport, WhichMesh};

const EXAMPLES: &str = "Examples:
  morph-lab verify face.glb
  morph-lab verify hand.glb --against face.glb --frames 1000
  morph-lab verify models/*.glb --frames 30";

/// Compare this library's answers about a model with brute force in exact arithmetic.
///
/// Two bodies take shapes from the mesh's own clips and at random (weights of either sign, above one, or twelve in sum). They are turned,
/// stretched, mirrored and sheared, from far apart to deep inside each other; some nearly touch, down to neighbouring floating-point
/// numbers. In every frame, all intersecting pairs of triangles are compared, and all boxes are checked against the vertices below them.
/// Then the bodies move from one such situation to another, and samples of what touches on the way are compared.
///
/// Triangles of a skinned mesh with a vertex without joint weights are left out with a warning: all of them would touch each other.
///
/// Columns of the table, one row for each leaf size of the trees: `missed` pairs that brute force finds and the trees do not, `spurious`
/// pairs that only the trees find, pairs that the fast test left `undecided` (they are decided by exact arithmetic, so they are not
/// errors), `containment` checks of boxes against vertices, and vertices `outside` their boxes.
///
/// The last line says whether all answers agree. The exit code is 1 if any answer differs, or if nothing touched, so that nothing was
/// compared. The smallest pair of triangles or vertex that differs is printed. Several models get one line each.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct VerifyArgs {
    /// .glb or .gltf files; - reads a .glb from standard input.
    #[arg(required = true)]
    models: Vec<PathBuf>,
    /// The model of the second body; by default it is the same mesh.
    #[arg(long, value_name = "MODEL")]
    against: Option<PathBuf>,
    /// The mesh of the first body: its index in the file, or its name.
    #[arg(long, value_name = "MESH", default_value_t)]
    mesh: MeshChoice,
    /// The mesh of the model that --against names.
    #[arg(long, value_name = "MESH", default_value_t, requires = "against")]
    against_mesh: MeshChoice,
    /// Number of situations to compare.
    #[arg(long, value_name = "N", default_value_t = 100)]
    frames: u64,
    /// Random seed; the same seed gives the same situations.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// The most triangles in a leaf of the trees, 1 to 255; by default, trees of several leaf sizes are compared.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    leaf: Option<u8>,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    json: bool,
}

/// Motions are compared for this share of the situations.
const FRAMES_PER_STEP: u64 = 4;

/// Draws situations, compares the answers, and reports differences.
pub(crate) fn verify(args: &VerifyArgs) -> Result<Verdict, AnyError> {
    let [model] = &args.models[..] else {
        return batch(args);
    };
    let report = compared(args, model, &args.mesh)?;
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.text())?;
    }
    Ok(report.verdict())
}

/// One line per model. Of every model, all meshes that can collide are compared with themselves.
fn batch(args: &VerifyArgs) -> Result<Verdict, AnyError> {
    let given = [
        ("--against", args.against.is_some()),
        ("--mesh", args.mesh != MeshChoice::default()),
    ];
    if let Some((flag, _)) = given.into_iter().find(|(_, given)| *given) {
        let reason = "works only with one model".to_owned();
        return Err(CliError::Flag { flag, reason }.into());
    }
    let mut batch = BatchReport::default();
    for model in &args.models {
        let meshes = match args.files.open(model) {
            Ok(file) => file.mesh_count(),
            Err(error) => {
                batch.add(model, 0, Err(error.into()));
                continue;
            }
        };
        for mesh in 0..meshes {
            batch.add(model, mesh, compared(args, model, &MeshChoice(mesh.to_string())));
        }
    }
    if args.json {
        print_json(&batch)?;
    } else {
        print(&batch.text())?;
    }
    match batch.failed() {
        0 => Ok(batch.verdict()),
        failed => Err(CliError::Batch {
            failed,
            all: batch.len(),
        }
        .into()),
    }
}

/// Compares a mesh with itself, or with another.
fn compared(args: &VerifyArgs, model: &Path, mesh: &MeshChoice) -> Result<VerifyReport, AnyError> {
    let (index, mesh, kept) = args.read(model, mesh, "--mesh")?;
    let second = args.against.as_ref();
    let second = second.map(|model| args.read(model, &args.against_mesh, "--against-mesh"));
    let second = second.transpose()?;
    let meshes = [&mesh, second.as_ref().map_or(&mesh, |(_, mesh, _)| mesh)];
    let first = WhichMesh {
        model: model.to_owned(),
        mesh: index,
        kept,
    };
    let second = args
        .against
        .as_ref()
        .zip(second.as_ref())
        .map(|(model, (index, _, kept))| WhichMesh {
            model: model.clone(),
            mesh: *index,
            kept: kept.clone(),
        });
    let which = [first.clone(), second.unwrap_or(first)];

    let leaf_sizes = args.leaf_sizes();
    doing(format!("building trees of {} triangles", meshes[0].triangles.len()));
    let mut sources = Vec::new();
    for &leaf_size in &leaf_sizes {
        let options = BuildOptions::default()
            .with_leaf_size(leaf_size)
            .map_err(SetUpError::from);
        let trees = options.and_then(|options| Trees::build(meshes, &options));
        sources.push(trees.map_err(|error| blame(error, &which, meshes))?);
    }
    let refused = |reason| LabError::Situation {
        file: model.to_owned(),
        mesh: index,
        name: mesh.name.clone(),
        reason,
    };
    let steps = count("frame", args.frames);
    let verification = compare(meshes, &mut sources, args.frames, args.seed, || steps.step());
    let verification = verification.map_err(refused)?;
    let motions = args.frames.div_ceil(FRAMES_PER_STEP);
    let steps = count("motion", motions);
    let motion = verify_motion(meshes, &mut sources, motions, args.seed, || steps.step());
    let motion = motion.map_err(refused)?;
    Ok(VerifyReport::new(which, &leaf_sizes, args.seed, &verification, motion))
}

impl VerifyArgs {
    fn leaf_sizes(&self) -> Vec<usize> {
        self.leaf.map_or(LEAF_SIZES.to_vec(), |leaf| vec![usize::from(leaf)])
    }

    /// Reads a mesh with its clips and counts the memory of its trees. Returns its index, and the numbers of its triangles if some are left
    /// out.
    fn read(
        &self,
        model: &Path,
        mesh: &MeshChoice,
        flag: &'static str,
    ) -> Result<(usize, MorphMesh, Option<Vec<u32>>), CliError> {
        let (file, index, mut mesh) = self.files.open_mesh(model, mesh, flag)?;
        let unweighted = leave_out_unweighted(&file, index, &mut mesh)?;
        let trees = self.leaf_sizes().len() as u64 * mesh.tree_bytes();
        count_memory(&file, index, trees, || "its trees".into())?;
        read_clips(&self.files, &file, index, None, &mut mesh, None);
        Ok((index, mesh, unweighted.map(|unweighted| unweighted.kept)))
    }
}

/// Names the file and index of the refused mesh.
fn blame(error: SetUpError, which: &[WhichMesh; 2], meshes: [&MorphMesh; 2]) -> AnyError {
    match error {
        SetUpError::Model { mesh, reason } => CliError::Mesh {
            file: which[mesh].model.clone(),
            mesh: which[mesh].mesh,
            name: meshes[mesh].name.clone(),
            reason: reason.into(),
        }
        .into(),
        other => other.into(),
    }
}
