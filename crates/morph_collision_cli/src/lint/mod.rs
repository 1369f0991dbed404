//! `morph-collide lint`: which weights make a mesh run into itself. [`Lint`] does the same with a file in memory.
//!
//! ```text
//! meshes --character--> one subject per skeleton or node tree
//! targets, clips, captures, expressions --poses--> shapes --search--> new pairs --regions--> regions --findings--> report
//! ```

mod baseline;
mod capture;
mod character;
mod findings;
mod html;
mod in_memory;
mod input;
mod members;
mod mixtures;
mod one_mesh;
mod options;
mod parts;
mod picture;
mod poses;
mod proof;
mod regions;
mod report;
mod search;
mod source;
mod subject;
mod suggest;
mod text;
mod work;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::text::Printable;

use crate::Verdict;
use crate::error::CliError;
use crate::files::drawn::DrawnArgs;
use crate::files::model::{FileArgs, MeshChoice, STANDARD};
use crate::messages;
use crate::options::tree::TreeArgs;
use crate::output;
use crate::output::file::OutputFile;
use crate::scene::fps;
use crate::touching::depth::ThresholdArgs;
use baseline::Baseline;
use options::LintOptions;
use report::LintReport;

pub use in_memory::{Lint, LintPage};

const EXAMPLES: &str = "Examples:
  Which sliders make a face run into itself, alone or two at a time, and how far can they go?
    morph-collide lint face.glb --pairs --suggest
  Does a shirt clip through the body in any clip?
    morph-collide lint body.glb --garment shirt.glb
  A check for a build pipeline that accepts what is known:
    morph-collide lint face.glb --capture take1.csv --write-baseline known.json
    morph-collide lint face.glb --capture take1.csv --baseline known.json";

/// Find the weights with which a character runs into itself.
///
/// All meshes that the scene draws under one skeleton or node tree are searched as one, against each other and themselves; targets with the
/// same name move together. They are tried with each target alone, in every frame of all clips that move them, with VRM expressions, and with
/// random mixtures of a few targets; with --pairs and --capture, also with two targets together and with recorded weights. Findings are listed
/// in this order: single targets, clips, captures, pairs, expressions, and mixtures last. Pairs of triangles that touch at rest are not
/// reported, and neither are triangles that share a vertex. Of two targets together, only what neither does alone is reported.
///
/// Triangles that touch and are connected form a region, and regions that overlap in several shapes of a target, pair, clip or capture are
/// one finding. `depth` is the farthest that one of its triangles would have to move, in the best direction, to leave the triangle that it
/// touches, in the file's unit. It is at most about the size of a triangle, so compare findings by it, but do not read it as the thickness
/// of an overlap.
///
/// With --min-depth, pairs that are less deep at rest do not count as touching there, so they are reported if they get deep enough.
///
/// Triangles of a skinned mesh with a vertex without joint weights are left out with a warning.
///
/// The exit code is 1 if there are findings that the baseline does not have, and 2 if there was nothing to try. All shapes that are tried are exact, but others may clip, too.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct LintArgs {
    /// A .glb or .gltf file; - reads a .glb from standard input.
    model: PathBuf,
    /// Search only this mesh, in its own space: its index in the file, or its name.
    #[arg(long, value_name = "MESH")]
    mesh: Option<MeshChoice>,
    #[command(flatten)]
    drawn: DrawnArgs,
    /// Also try all pairs of targets, each at weights of 0.5 and 1.
    #[arg(long)]
    pairs: bool,
    /// Also try recorded weights: a CSV file with a line of target names and a line of numbers for each frame. Can be repeated.
    ///
    /// Columns that are not named like a target are ignored with a warning. Targets without a column keep the file's default weights.
    #[arg(long, value_name = "WEIGHTS.csv")]
    capture: Vec<PathBuf>,
    /// Number of random mixtures: two to five targets, or weights near those of a random frame of the clips and captures.
    #[arg(long, value_name = "N", default_value_t = LintOptions::MIXTURES)]
    mixtures: usize,
    /// Random seed; the same seed gives the same mixtures.
    #[arg(long, value_name = "S", default_value_t = LintOptions::SEED)]
    seed: u64,
    /// Play only this animation: its name or its index, or FILE#NAME for an animation of another file (see `morph-collide query --help`). Can
    /// be repeated; by default, all animations are played.
    #[arg(long, value_name = "NAME")]
    clip: Vec<String>,
    /// Play animations in loops: their end is their beginning. Without this option, their last pose is tried, too.
    #[arg(long = "loop")]
    is_loop: bool,
    /// Frames per second of animations; 30 by default. The end of an animation is a frame in any case.
    #[arg(long, value_name = "N", value_parser = fps, allow_hyphen_values = true)]
    fps: Option<f32>,
    /// For each target and pair of targets that clips, search the largest weight that does not.
    ///
    /// The weight is increased in 16 steps until the mesh clips, and then found to within 1/512 of the weight that clips. A query confirms
    /// that nothing new touches at the weight that is printed.
    #[arg(long)]
    suggest: bool,
    /// Compare each mesh with a garment instead of with itself: a mesh of this file, or of the same one.
    ///
    /// Both must be in the same space. Targets with the same name get the same weights, so a clip or a capture moves both. If joints move the
    /// mesh, they must move the garment, too, under the same names.
    #[arg(long, value_name = "MODEL2")]
    garment: Option<PathBuf>,
    /// The mesh of --garment: its index in the file, or its name; 0 by default.
    #[arg(long, value_name = "MESH", requires = "garment")]
    garment_mesh: Option<MeshChoice>,
    /// Also prove which pairs of triangles never touch for any weights from 0 to 1, and report the weights that the proof comes across otherwise.
    ///
    /// Skinned meshes have no proof.
    #[arg(long)]
    prove: bool,
    /// How many parts of the box of all weights the proof looks at for each pair of triangles; more parts find more weights that clip.
    #[arg(long, value_name = "N", default_value_t = LintOptions::EFFORT, requires = "prove")]
    effort: u32,
    /// Write a page with a table and a picture of each finding.
    #[arg(long, value_name = "OUT.html")]
    html: Option<PathBuf>,
    /// Accept the findings of this file, unless they became more than 10 % deeper.
    #[arg(long, value_name = "FILE.json")]
    baseline: Option<PathBuf>,
    /// Write all findings to a file for --baseline; the exit code is then 0.
    #[arg(long, value_name = "FILE.json", conflicts_with = "baseline")]
    write_baseline: Option<PathBuf>,
    /// The number of threads; by default, one per core.
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    #[command(flatten)]
    thresholds: ThresholdArgs,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    json: bool,
}

impl LintArgs {
    /// What to try, without what is done with the result.
    fn options(&self) -> LintOptions {
        LintOptions {
            model: self.model.clone(),
            mesh: self.mesh.clone(),
            drawn: self.drawn.clone(),
            pairs: self.pairs,
            capture: self.capture.clone(),
            mixtures: self.mixtures,
            seed: self.seed,
            clip: self.clip.clone(),
            is_loop: self.is_loop,
            fps: self.fps.unwrap_or(LintOptions::FPS),
            suggest: self.suggest,
            garment: self.garment.clone(),
            garment_mesh: self.garment_mesh.clone(),
            prove: self.prove,
            effort: self.effort,
            pictures: self.html.is_some(),
            threads: self.threads,
            thresholds: self.thresholds,
            tree: self.tree.build(),
            files: self.files.clone(),
        }
    }
}

/// Tries all shapes of all meshes and reports.
pub(crate) fn lint(args: &LintArgs) -> Result<Verdict, CliError> {
    let budget = args.files.budget();
    let baseline = args.baseline.as_ref();
    let baseline = baseline
        .map(|path| Baseline::read(path, &args.files, &budget))
        .transpose()?;
    if args.mesh.is_some() {
        args.drawn
            .refuse("--mesh names a mesh, which is taken wherever it is")?;
    }
    let file = args.files.open_within(&args.model, &budget)?;
    let mut inputs: Vec<PathBuf> = file.files();
    inputs.extend(args.capture.iter().chain(&args.garment).cloned());
    let written = args.write_baseline.as_ref();
    let written = written
        .map(|path| OutputFile::create("--write-baseline", path, &inputs))
        .transpose()?;
    inputs.extend(args.baseline.iter().cloned());
    let page = args.html.as_ref();
    let page = page
        .map(|path| OutputFile::create("--html", path, &inputs))
        .transpose()?;
    if let (Some(page), Some(written)) = (&page, &written)
        && page.replaces_the_same_as(written)
    {
        let reason = "is the same file as --write-baseline; choose another name".to_owned();
        return Err(CliError::Flag { flag: "--html", reason });
    }
    let is_stdin = |path: &PathBuf| path.as_os_str() == STANDARD;
    let others = args.capture.iter().map(|path| ("--capture", path));
    let others = others.chain(args.baseline.iter().map(|path| ("--baseline", path)));
    let mut others = others.chain(args.garment.iter().map(|path| ("--garment", path)));
    if let Some((flag, _)) = others.find(|(_, path)| is_stdin(path)) {
        let reason = "only the model can be read from standard input".to_owned();
        return Err(CliError::Flag { flag, reason });
    }
    let mut report = report_of(&args.options(), &file)?;
    if let Some(baseline) = &baseline {
        for mesh in &mut report.meshes {
            for finding in &mut mesh.findings {
                finding.accepted = baseline.accepts(finding);
            }
        }
    }
    let is_recorded = written.is_some();
    if let Some(written) = written {
        written.write(|out| Baseline::new(report.all()).write(out))?;
    }
    if let Some(page) = page {
        page.write(|out| html::write(&report, out))?;
    }
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text())?;
    }
    Ok(match report.unaccepted() {
        0 => Verdict::Clean,
        _ if is_recorded => Verdict::Clean,
        _ => Verdict::FoundWrong,
    })
}

/// Tries all shapes of the meshes of an open file. There must be any.
fn report_of(options: &LintOptions, file: &GltfFile) -> Result<LintReport, CliError> {
    for expression in file.expressions() {
        for problem in &expression.problems {
            messages::complain(format_args!(
                "warning: left out: expression \"{}\": {problem}",
                Printable(&expression.name)
            ));
        }
    }
    let subjects = input::subjects(options, file)?;
    let mut report = LintReport {
        model: options.model.clone(),
        thresholds: options.thresholds,
        meshes: Vec::with_capacity(subjects.len()),
    };
    for subject in &subjects {
        report.meshes.push(work::lint_mesh(options, file, subject)?);
    }
    match report.shapes() {
        0 => Err(CliError::NothingTried {
            file: options.model.clone(),
        }),
        _ => Ok(report),
    }
}
