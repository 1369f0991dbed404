//! `morph-collide scene`: makes a scene file from model files.
//!
//! ```text
//! A.glb B.glb --build--> bodies, clips --place--> placements --> scene.json
//! ```

pub(crate) mod build;
mod place;

use std::path::{Path, PathBuf};

use clap::Args;
use morph_collision_models::scenes::{BodyState, Scene};
use morph_collision_models::weight_list::{TargetNames, WeightList};

use crate::error::CliError;
use crate::files::clip_files::ClipFiles;
use crate::files::clips::NoClip;
use crate::files::drawn::DrawnArgs;
use crate::files::model::{FileArgs, MeshChoice, STANDARD, has_extension};
use crate::options::frame_times::FrameTimes;
use crate::options::shape::WeightArg;
use crate::output;
use crate::output::file::OutputFile;
use build::{Candidate, Meshes, ModelSpec, candidates, check_stdin, number_names, take_frames};
use place::Place;

const EXAMPLES: &str = "Examples:
  Two characters, the second one metre to the right and facing the first, both walking:
    morph-collide scene hero.glb villain.glb --clip walk --place 0,0,0 --place x=1,turn-y=180 > fight.json
  A sword that passes through a body in 60 frames:
    morph-collide scene body.glb sword.glb --place 0,0,0 --place x=-2..2 --frames 60 > cut.json
  All that a file draws, where its nodes put it:
    morph-collide scene robot.glb#all --node-transforms --clip Dance > dance.json";

/// Make a scene file from model files: one body per model, with clips, weights and placements.
///
/// The scene goes to standard output. `run`, `motion`, `sweep` and `export` read it, and docs/scene.md describes the format. Paths in it
/// are relative to the file given by --output, or else to the current directory.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SceneArgs {
    /// .glb or .gltf files. FILE#2 or FILE#NAME is another mesh than the first, and FILE#all is a body for every mesh that is drawn.
    #[arg(required = true, value_name = "MODEL")]
    models: Vec<String>,
    /// The animation that bodies play: its name or its index, or FILE#NAME for an animation of another file (see `morph-collide query
    /// --help`). Give it once for all models, or once per model, with "" for none.
    ///
    /// Given once, models without this animation stay at rest.
    #[arg(long, value_name = "NAME")]
    clip: Vec<String>,
    /// Weights of the targets: NAME=W,NAME=W,.., one number per target, or @FILE. Give them once for all models, or once per model, with ""
    /// for none. See `morph-collide query --help`.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true, value_parser = optional_weights)]
    weights: Vec<OptionalWeights>,
    /// Where a model stands: X,Y,Z or KEY=VALUE,.. Give it once per model, in order; the others stand at the origin.
    ///
    /// Keys are x, y, z, turn-x, turn-y, turn-z (degrees, applied in the order given), scale, scale-x, scale-y and scale-z. A value A..B
    /// changes from A in the first frame to B in the last. Turns may be repeated; other keys may be given once.
    #[arg(long, value_name = "PLACE", allow_hyphen_values = true)]
    place: Vec<Place>,
    /// Put meshes where the nodes of their files put them, and move them as clips move the nodes. Without this option, a mesh without
    /// joints is in its own space.
    #[arg(long)]
    node_transforms: bool,
    #[command(flatten)]
    drawn: DrawnArgs,
    /// Frames per second.
    #[arg(long, value_name = "N", default_value_t = 30.0, value_parser = fps, allow_hyphen_values = true)]
    fps: f32,
    /// Play clips in loops. Without this option, a clip that is shorter than another one holds its last pose.
    #[arg(long = "loop", requires = "clip")]
    is_loop: bool,
    /// Number of frames; by default as many as the longest clip takes, with its end, 60 if only placements change, or else 1.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// The file to write; - is standard output.
    #[arg(long, short, value_name = "OUT.json", default_value = STANDARD)]
    output: PathBuf,
    #[command(flatten)]
    files: FileArgs,
}

#[derive(Clone, Debug, PartialEq)]
struct OptionalWeights(Option<WeightList>);

fn optional_weights(text: &str) -> Result<OptionalWeights, String> {
    if text.is_empty() {
        return Ok(OptionalWeights(None));
    }
    text.parse().map(|WeightArg(list)| OptionalWeights(Some(list)))
}

pub(crate) fn fps(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|fps: &f32| *fps > 0.0 && *fps <= 100_000.0);
    number.ok_or_else(|| "expected a number above 0 and at most 100000".to_owned())
}

/// What is counted for a body's state in a frame when `run` reads the scene, if it has a clip and a few weights.
const BYTES_PER_STATE: u64 = 3072;

/// If only placements change.
const FRAMES_OF_PLACEMENTS: usize = 60;

/// Reads the models, and writes the scene.
pub(crate) fn scene(args: &SceneArgs) -> Result<(), CliError> {
    let models = models(args)?;
    if models.iter().all(|spec| spec.meshes != Meshes::All) {
        args.drawn
            .refuse("each model is one mesh, which is taken wherever it is; write FILE#all for all that is drawn")?;
    }
    let mut bodies = Vec::new();
    let mut clips = Vec::new();
    let mut states = Vec::new();
    let mut seconds = 0.0_f32;
    let mut complaint = None;
    let mut inputs = Vec::new();
    let budget = args.files.budget();
    let mut clip_files = ClipFiles::new(&args.files, &budget, Path::new(""));
    for (model, spec) in models.iter().enumerate() {
        let clip = of_model(&args.clip, model).filter(|clip| !clip.is_empty());
        let wanted = clip.map_or(&[][..], std::slice::from_ref);
        let (file, found) = candidates(spec, args.node_transforms, &args.drawn, wanted, &mut clip_files)?;
        inputs.extend(file.files());
        for candidate in found {
            let clip = match clip {
                None => None,
                Some(clip) => match candidate.clip(&file, &clip_files, clip) {
                    Ok(clip) => Some(clip),
                    Err(NoClip::Broken(reason)) => return Err(CliError::Flag { flag: "--clip", reason }),
                    Err(NoClip::Unknown(reason)) => {
                        complaint.get_or_insert(format!("{}: {reason}", spec.file.display()));
                        None
                    }
                },
            };
            seconds = clip.as_ref().map_or(seconds, |(_, length)| seconds.max(*length));
            clips.push(clip);
            states.push(state(args, model, &candidate)?);
            bodies.push(candidate.body);
        }
    }
    // A clip that some bodies lack is fine, and so is a model that needs none, but a name that fits nothing is a mistake.
    let is_missing = clips.iter().all(Option::is_none) || args.clip.len() > 1;
    if let (Some(reason), true) = (complaint, is_missing) {
        return Err(CliError::Flag { flag: "--clip", reason });
    }
    clip_files.warn();
    inputs.extend(clip_files.inputs());
    let moves = args.place.iter().any(Place::moves);
    let times = match args.frames {
        Some(frames) => FrameTimes::counted(frames as usize, args.fps),
        None if seconds > 0.0 => FrameTimes::of_clip(seconds, args.fps, args.is_loop),
        None if moves => FrameTimes::counted(FRAMES_OF_PLACEMENTS, args.fps),
        None => FrameTimes::counted(1, args.fps),
    };
    let frames = times.len();
    // `run` must be able to read the scene with the same memory limit.
    take_frames(frames, bodies.len(), BYTES_PER_STATE, &budget, "--frames")?;
    for (name, _) in clips.iter_mut().flatten() {
        *name = clip_files.renamed(name, |file| relative(file, &args.output));
    }
    let mut all = build::frames_of_clips(&clips, &times, args.is_loop);
    for (frame, of_frame) in all.iter_mut().enumerate() {
        let share = frame as f32 / frames.saturating_sub(1).max(1) as f32;
        for (body, (weights, place)) in of_frame.iter_mut().zip(&states) {
            body.weights = weights.clone();
            place.apply(share, body);
        }
    }
    number_names(&mut bodies);
    let file = OutputFile::create("--output", &args.output, &inputs)?;
    for body in &mut bodies {
        body.model = relative(&body.model, &args.output);
    }
    let scene = build::scene_of(bodies, all);
    let json = scene.to_json(&args.output)?;
    file.write(|out| out.write_all(output::printable_json(&json).as_bytes()))
}

/// The model files and meshes, with as many options as models.
fn models(args: &SceneArgs) -> Result<Vec<ModelSpec>, CliError> {
    let first = Meshes::One(MeshChoice::default());
    let models: Vec<ModelSpec> = args
        .models
        .iter()
        .map(|model| ModelSpec::parse(model, &first))
        .collect();
    check_stdin(&models)?;
    let count = models.len();
    let too_many = |flag, given: usize| {
        let models = if count == 1 { "model" } else { "models" };
        let reason = format!("it is given {given} times for {count} {models}");
        Err(CliError::Flag { flag, reason })
    };
    if args.clip.len() > 1 && args.clip.len() != count {
        return too_many("--clip", args.clip.len());
    }
    if args.weights.len() > 1 && args.weights.len() != count {
        return too_many("--weights", args.weights.len());
    }
    if args.place.len() > count {
        return too_many("--place", args.place.len());
    }
    Ok(models)
}

/// The value of a list that has one entry for all models or one for each.
fn of_model<T>(list: &[T], model: usize) -> Option<&T> {
    match list {
        [only] => Some(only),
        all => all.get(model),
    }
}

/// The weights and the placement of a body.
fn state(args: &SceneArgs, model: usize, candidate: &Candidate) -> Result<(WeightList, Place), CliError> {
    let place = args.place.get(model).cloned().unwrap_or_default();
    let weights = of_model(&args.weights, model).and_then(|weights| weights.0.clone());
    let Some(weights) = weights else {
        return Ok((WeightList::default(), place));
    };
    // Checked now, so that the scene can be used.
    let names = TargetNames::new(candidate.target_names());
    let (targets, wrong) = (candidate.target_names().len(), |reason: String| CliError::Flag {
        flag: "--weights",
        reason: format!("{}: {reason}", candidate.body.model.display()),
    });
    let resolved = names.resolve(&weights, vec![0.0; targets]);
    let given = resolved.map_err(|error| wrong(error.to_string()))?.len();
    if given != targets {
        return Err(wrong(format!("{given} weights for {targets} targets")));
    }
    Ok((weights, place))
}

/// The path of a model as seen from the directory of the scene file. Stays as it is if there is no relative path.
fn relative(model: &Path, scene: &Path) -> PathBuf {
    if model == Path::new(STANDARD) || model.is_absolute() {
        return model.to_owned();
    }
    let directory = match scene.parent() {
        Some(parent) if parent != Path::new("") && scene != Path::new(STANDARD) => parent,
        // The scene is in the current directory.
        _ => return model.to_owned(),
    };
    let (Ok(model_path), Ok(directory)) = (model.canonicalize(), directory.canonicalize()) else {
        return model.to_owned();
    };
    let shared = model_path
        .components()
        .zip(directory.components())
        .take_while(|(one, other)| one == other)
        .count();
    let up = directory
        .components()
        .skip(shared)
        .map(|_| std::path::Component::ParentDir);
    up.chain(model_path.components().skip(shared)).collect()
}

/// Reads a scene file, or makes a scene from a model file.
pub(crate) fn is_scene(path: &Path) -> bool {
    has_extension(path, &["json"])
}

/// A scene with one frame in which nothing moves.
pub(crate) fn still(scene: &mut Scene) {
    scene.frames = vec![vec![BodyState::default(); scene.bodies.len()]];
}
