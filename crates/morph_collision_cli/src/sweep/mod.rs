//! `morph-collide sweep`: what touches while clips play.
//!
//! ```text
//! model --scene::build--> frames of all clips --Cast--> posed bodies --search--> rows --report--> stdout, OUT.csv
//! ```

mod report;
mod rows;

use std::path::{Path, PathBuf};

use clap::Args;
use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::scenes::Scene;

use crate::Verdict;
use crate::cast::Cast;
use crate::cast::posed::Posed;
use crate::error::CliError;
use crate::files::clip_files::ClipFiles;
use crate::files::drawn::DrawnArgs;
use crate::files::model::{FileArgs, MeshChoice};
use crate::options::frame_times::FrameTimes;
use crate::options::tree::TreeArgs;
use crate::output;
use crate::output::file::OutputFile;
use crate::scene::build::{
    Meshes, ModelSpec, candidates, clips_of, frames_of_clips, number_names, playable, scene_of, take_frames,
};
use crate::scene::{fps, is_scene};
use crate::touching::Among;
use crate::touching::depth::ThresholdArgs;
use report::SweepReport;
use rows::Label;

const EXAMPLES: &str = "Examples:
  Which triangles of a character touch while it walks, and which targets and joints bring them together:
    morph-collide sweep character.glb --clip walk
  A check for a build pipeline, which fails if an animation makes something touch that does not touch at rest:
    morph-collide sweep character.glb --fail-on-touch --ignore-rest";

/// Play clips and report in which frames a mesh intersects itself or other meshes, how deep, and which targets and joints move the
/// triangles that touch.
///
/// Of a model, all meshes that are drawn are used, where its nodes put them. `new` counts the pairs of triangles that do not touch at rest. `depth` is how
/// far two triangles, or two meshes, would have to move apart, in the file's unit. With --min-depth, rows that are less deep are left out, and
/// --fail-on-touch ignores them. Targets are sorted by how far they move the touching
/// vertices in that frame, and joints by their influence on them.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SweepArgs {
    /// A .glb or .gltf file, or a scene file (.json).
    input: PathBuf,
    /// Play only this animation: its name or its index, or FILE#NAME for an animation of another file (see `morph-collide query --help`). Can
    /// be repeated; by default, all animations of the model are played.
    #[arg(long, value_name = "NAME")]
    clip: Vec<String>,
    /// Use only this mesh of the model: its index in the file, or its name.
    #[arg(long, value_name = "MESH")]
    mesh: Option<MeshChoice>,
    #[command(flatten)]
    drawn: DrawnArgs,
    /// Play animations in loops: their end is their beginning. Without this option, their last pose is tried, too.
    #[arg(long = "loop")]
    is_loop: bool,
    /// Frames per second; 30 by default. The end of an animation is a frame in any case.
    #[arg(long, value_name = "N", value_parser = fps, allow_hyphen_values = true)]
    fps: Option<f32>,
    /// Which pairs of triangles to look at.
    #[arg(long, value_enum, default_value_t = Among::All)]
    among: Among,
    /// End with exit code 1 if any triangles touch.
    #[arg(long)]
    fail_on_touch: bool,
    /// Leave out pairs of triangles that also touch at rest. In a scene, only pairs within one body have a rest.
    #[arg(long)]
    ignore_rest: bool,
    #[command(flatten)]
    thresholds: ThresholdArgs,
    /// Write all rows to a CSV file; - writes it to standard output, and the summary to standard error.
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    json: bool,
}

/// Upper bound on the bytes that a body's state in a frame takes, as in a scene file.
const BYTES_PER_STATE: u64 = 288;

/// Bodies with this project's trees.
type Swept = Cast<Vec<Posed>>;

/// Plays all clips and reports.
pub(crate) fn sweep(args: &SweepArgs) -> Result<Verdict, CliError> {
    let from_scene = is_scene(&args.input);
    let budget = args.files.budget();
    let (scene, labels) = if from_scene {
        from_scene_file(args, &budget)?
    } else {
        from_model(args, &budget)?
    };
    // Paths of a scene made from a model are not relative to it.
    let path = if from_scene { &*args.input } else { Path::new("sweep") };
    let mut cast = Cast::load(path, &scene, &args.tree, &args.files, &budget)?;
    let csv = args.csv.as_deref();
    let csv = csv
        .map(|path| OutputFile::create("--csv", path, &cast.inputs))
        .transpose()?;
    let rows = rows::rows(
        &mut cast,
        &labels,
        args.among,
        !from_scene,
        args.ignore_rest,
        args.thresholds,
    )?;
    let report = SweepReport::new(cast.names, cast.frames.len(), args.ignore_rest, args.thresholds, rows);
    if let Some(csv) = csv {
        csv.write(|out| report.write_csv(out))?;
    }
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text())?;
    }
    Ok(match args.fail_on_touch && report.anything_touches() {
        true => Verdict::FoundWrong,
        false => Verdict::Clean,
    })
}

fn from_scene_file(args: &SweepArgs, budget: &MemoryBudget) -> Result<(Scene, Vec<Label>), CliError> {
    let refuse = |flag, given| match given {
        true => Err(CliError::Flag {
            flag,
            reason: "a scene file already says what happens in every frame".to_owned(),
        }),
        false => Ok(()),
    };
    refuse("--clip", !args.clip.is_empty())?;
    refuse("--mesh", args.mesh.is_some())?;
    refuse("--fps", args.fps.is_some())?;
    args.drawn
        .refuse("a scene file already says what happens in every frame")?;
    refuse("--loop", args.is_loop)?;
    let scene = args.files.read_scene(&args.input, budget)?;
    let label = |states: &Vec<morph_collision_models::scenes::BodyState>| {
        let clip = states.iter().find_map(|state| state.clip.clone());
        let seconds = states.iter().find_map(|state| state.time);
        Label { clip, seconds }
    };
    let labels = scene.frames.iter().map(label).collect();
    Ok((scene, labels))
}

/// A scene in which all bodies of a model play its clips, one after the other.
fn from_model(args: &SweepArgs, budget: &MemoryBudget) -> Result<(Scene, Vec<Label>), CliError> {
    let meshes = args.mesh.clone().map_or(Meshes::All, Meshes::One);
    let spec = ModelSpec {
        file: args.input.clone(),
        meshes,
    };
    if args.mesh.is_some() {
        args.drawn
            .refuse("--mesh names a mesh, which is taken wherever it is")?;
    }
    // What is read here is dropped before the bodies are made.
    let mut clip_files = ClipFiles::new(&args.files, &args.files.budget(), Path::new(""));
    let (file, found) = candidates(&spec, true, &args.drawn, &args.clip, &mut clip_files)?;
    let names = if args.clip.is_empty() {
        playable(&found, &file)
    } else {
        args.clip.clone()
    };
    let fps = args.fps.unwrap_or(30.0);
    let (mut frames, mut labels) = (Vec::new(), Vec::new());
    for name in &names {
        let clips = clips_of(&found, &file, &clip_files, name).map_err(|error| CliError::Flag {
            flag: "--clip",
            reason: error.reason(),
        })?;
        let seconds = clips
            .iter()
            .flatten()
            .fold(0.0, |longest: f32, (_, length)| longest.max(*length));
        let times = FrameTimes::of_clip(seconds, fps, args.is_loop);
        take_frames(times.len(), clips.len(), BYTES_PER_STATE, budget, "--fps")?;
        labels.extend((0..times.len()).map(|frame| Label {
            clip: Some(name.clone()),
            seconds: Some(times.seconds(frame) as f32),
        }));
        frames.extend(frames_of_clips(&clips, &times, args.is_loop));
    }
    let mut bodies: Vec<_> = found.into_iter().map(|candidate| candidate.body).collect();
    number_names(&mut bodies);
    let mut scene = scene_of(bodies, frames);
    if names.is_empty() {
        crate::scene::still(&mut scene);
        labels.push(Label::default());
    }
    Ok((scene, labels))
}
