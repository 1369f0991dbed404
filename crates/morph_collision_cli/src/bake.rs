//! `morph-collide bake`: writes the trees of a model's meshes to a file that a game ships beside the model.
//!
//! A tree fits a mesh as `bevy_morph_collision` reads it from Bevy: one primitive, its vertices as Bevy stores them, and the first four
//! influences of each.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use glam::Vec3;
use morph_collision::proof::{Effort, ProofOutcome, SelfProof, WeightBox};
use morph_collision::{MorphBvh, SavedTree, TreeFile};
use morph_collision_models::gltf::read::{GltfFile, Part};
use morph_collision_models::inspect::MeshError;
use morph_collision_models::memory::Bytes;
use morph_collision_models::mesh::{InfluenceSet, MeshSkin, MorphMesh};
use morph_collision_models::skeleton::Skeleton;
use morph_collision_models::text::Grouped;
use serde::Serialize;

use crate::error::CliError;
use crate::files::model::{FileArgs, STANDARD};
use crate::messages::{complain, counted, progress};
use crate::options::tree::TreeArgs;
use crate::output;
use crate::output::file::OutputFile;

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

#[derive(Debug, Serialize)]
struct Baked {
    label: String,
    mesh: String,
    joints: Option<u32>,
    triangles: usize,
    targets: usize,
    certificates: bool,
}

/// A primitive without a tree.
#[derive(Debug, Serialize)]
struct NotBaked {
    label: String,
    reason: String,
}

/// Builds the trees and writes them.
pub(crate) fn bake(args: &BakeArgs) -> Result<(), CliError> {
    let file = args.files.open(&args.model)?;
    if file.skips_bad() {
        return Err(CliError::Flag {
            flag: "--skip-bad",
            reason: "only meshes without bad triangles can be baked".to_owned(),
        });
    }
    let output = OutputFile::create("--output", &args.output()?, file.files())?;
    let mut found = Found::default();
    for mesh in 0..file.mesh_count() {
        for part in 0..file.part_count(mesh) {
            file.budget().lend(|| bake_part(args, &file, mesh, part, &mut found));
        }
    }
    let Found { trees, baked, not_baked } = found;
    for NotBaked { label, reason } in &not_baked {
        complain(format_args!("warning: {}#{label} is not baked: {reason}", args.model.display()));
    }
    if trees.is_empty() {
        let reason = "it has no mesh to bake; --rigid bakes meshes that nothing deforms, too".to_owned();
        return Err(CliError::NoUsableMesh { file: args.model.clone(), reason });
    }
    let bytes = TreeFile { trees }.to_bytes();
    output.write(|out| out.write_all(&bytes))?;
    let report = BakeReport {
        file: args.output()?.display().to_string(),
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

#[derive(Default)]
struct Found {
    trees: Vec<SavedTree>,
    baked: Vec<Baked>,
    not_baked: Vec<NotBaked>,
}

/// Bakes a primitive, once for each number of joints with which nodes show it.
fn bake_part(args: &BakeArgs, file: &GltfFile, mesh: usize, part: usize, found: &mut Found) {
    let label = format!("Mesh{mesh}/Primitive{part}");
    progress::doing(format!("building the tree of {label}"));
    let mut not_baked = |reason: String| {
        found.not_baked.push(NotBaked {
            label: label.clone(),
            reason,
        });
    };
    let read = match file.part(mesh, part) {
        Ok(part) => part,
        Err(error) => return not_baked(error.to_string()),
    };
    let mut joints: Vec<Option<usize>> = file.joint_counts(mesh).into_iter().collect();
    if joints.is_empty() {
        joints.push(None);
    }
    let is_deformed = |joints: Option<usize>| joints.is_some() && !read.influences.is_empty() || !read.mesh.targets.is_empty();
    joints.retain(|&joints| args.rigid || is_deformed(joints));
    if joints.is_empty() || read.mesh.triangles.is_empty() && read.is_list {
        return;
    }
    if !read.is_list {
        return not_baked("it is drawn as strips or fans, and only separate triangles can be baked".to_owned());
    }
    let drawn = as_bevy_draws(read);
    for joints in joints {
        match tree(args, file, &drawn, joints) {
            Ok(tree) => {
                found.baked.push(Baked {
                    label: label.clone(),
                    mesh: file.mesh_name(mesh),
                    joints: joints.map(|count| count as u32),
                    triangles: drawn.mesh.triangles.len(),
                    targets: drawn.mesh.targets.len(),
                    certificates: tree.certificates().is_some(),
                });
                found.trees.push(SavedTree {
                    label: label.clone(),
                    joints: joints.map(|count| count as u32),
                    layout: tree.layout(),
                });
            }
            Err(error) => not_baked(error.to_string()),
        }
    }
}

/// Bevy gives the triangles of a mesh without normals their own vertices, and it reads one set of influences.
fn as_bevy_draws(mut part: Part) -> Part {
    part.influences.truncate(1);
    let corners = part.mesh.triangles.as_flattened().to_vec();
    if !part.has_normals && corners.iter().all(|&corner| (corner as usize) < part.mesh.positions.len()) {
        let MorphMesh { positions, triangles, targets, .. } = &mut part.mesh;
        let spread = |of: &mut Vec<Vec3>| *of = corners.iter().map(|&corner| of[corner as usize]).collect();
        spread(positions);
        targets.iter_mut().filter(|target| !target.is_empty()).for_each(spread);
        for InfluenceSet { joints, weights } in &mut part.influences {
            *joints = corners.iter().map(|&corner| joints[corner as usize]).collect();
            *weights = corners.iter().map(|&corner| weights[corner as usize]).collect();
        }
        *triangles = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    }
    part
}

fn tree(args: &BakeArgs, file: &GltfFile, part: &Part, joints: Option<usize>) -> Result<Arc<MorphBvh>, MeshError> {
    let mut mesh = part.mesh.clone();
    mesh.skin = joints.filter(|_| !part.influences.is_empty()).map(|count| MeshSkin {
        sets: part.influences.clone(),
        skeleton: Skeleton::separate(count),
    });
    let what = || "its tree".to_owned();
    file.budget().take(mesh.tree_bytes(), 1, what)?;
    let tree = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &args.tree.build()));
    if args.certificates && mesh.skin.is_none() && !mesh.targets.is_empty() {
        certify(&tree).map_err(|error| MeshError::Pose(error.to_string()))?;
    }
    Ok(tree)
}

/// Proves for weights from 0 to 1 which triangles never touch.
fn certify(tree: &Arc<MorphBvh>) -> Result<(), morph_collision::InputError> {
    let weights = WeightBox::unit(tree.model().target_count());
    let proof = SelfProof::new(tree, &weights, Effort::default())?;
    let steps = progress::count("part of the proof", proof.parts() as u64);
    let mut outcome = ProofOutcome::default();
    for part in 0..proof.parts() {
        outcome.join(proof.run_part(part));
        steps.step();
    }
    tree.set_certificates(proof.certificates(&outcome)?)?;
    Ok(())
}
