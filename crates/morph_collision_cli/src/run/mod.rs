//! `morph-collide run`: replay a scene of scripted bodies and report which triangles intersect.
//!
//! ```text
//! scene.json --Cast--> bodies of a method --replay--> hits and times per frame --report, pairs_csv, picture--> stdout, OUT.csv, OUT.png
//! ```

mod options;
mod pairs_csv;
mod picture;
mod replay;
mod report;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use morph_collision_testkit::rivals::Method;
use morph_collision_testkit::scenes::Scene;

use crate::cast::Cast;
use crate::error::CliError;
use crate::model_file::FileArgs;
use crate::output;
use crate::output_file::OutputFile;
use crate::picture::Picture;
use crate::progress::ProgressArgs;

use options::MethodArgs;
use picture::{Drawn, PictureArgs};
use replay::Replay;
use report::RunReport;

/// Replay a scene frame by frame and report which bodies and triangles intersect.
///
/// A scene is a JSON file that lists its bodies, {"model":"a.glb","mesh":0} with the path relative to the scene. For every frame
/// it gives each body's "weights", "scale", "rotation" (a quaternion x,y,z,w) and "translation".
#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// The scene file.
    scene: PathBuf,
    /// How much to find out about each pair of bodies.
    #[arg(long, value_enum, default_value_t = Mode::All)]
    mode: Mode,
    #[command(flatten)]
    how: MethodArgs,
    /// Write the pairs to a CSV file: `frame,body_a,body_b,triangle_a,triangle_b`.
    ///
    /// With the modes `first` and `any` there is one line per pair of bodies that touch.
    #[arg(long, value_name = "OUT.csv")]
    pairs: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureArgs,
    #[command(flatten)]
    files: FileArgs,
    #[command(flatten)]
    progress: ProgressArgs,
    /// Print one JSON object instead of a summary.
    #[arg(long)]
    json: bool,
}

/// The bodies of a scene, held by a method.
type Played = Cast<Box<dyn Method>>;

/// How much to find out about each pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Mode {
    /// Every pair of triangles that intersect.
    All,
    /// One pair of triangles that intersect.
    First,
    /// Only whether any triangles intersect.
    Any,
}

/// Loads, replays and reports a scene. Reported times exclude loading and writing.
pub(crate) fn run(args: &RunArgs) -> Result<(), CliError> {
    args.how.check(args.mode)?;
    let scene = Scene::read_within(&args.scene, args.files.memory_limit())?;
    let mut cast = Cast::load(&args.scene, &scene, &args.how, &args.files)?;
    args.picture.check(cast.frames.len())?;
    // Checked before the replay, so that a path that cannot be written fails early.
    let output_file = |flag, path: &Option<PathBuf>| {
        let path = path.as_deref();
        path.map(|path| OutputFile::create(flag, path, &cast.inputs))
            .transpose()
    };
    let pairs_file = output_file("--pairs", &args.pairs)?;
    let picture_file = output_file("--picture", &args.picture.picture)?;
    if let (Some(pairs), Some(picture)) = (&pairs_file, &picture_file)
        && pairs.replaces_the_same_as(picture)
    {
        return Err(CliError::Flag {
            flag: "--picture",
            reason: "--pairs names the same file; choose another name".to_owned(),
        });
    }

    let progress = args.progress.start("frame", cast.frames.len() as u64);
    let replay = replay::replay(&mut cast, args.mode, pairs_file.is_some(), &progress)?;

    if let Some(file) = pairs_file {
        file.write(|out| pairs_csv::write_rows(out, &replay.hits))?;
    }
    let drawn = match picture_file {
        Some(file) => Some(draw(&mut cast, args, &replay, file)?),
        None => None,
    };
    let report = RunReport::new(&replay, cast.bodies, args.mode, args.how.method(), drawn);
    if args.json {
        output::print_json(&report)
    } else {
        output::print(&report.summary())
    }
}

/// Draws a frame of a replay into `file`.
fn draw(cast: &mut Played, args: &RunArgs, replay: &Replay, file: OutputFile) -> Result<Drawn, CliError> {
    let frame = args.picture.frame(&replay.frames);
    let hits = replay::hits_of_frame(cast, args.mode, frame, replay.hits.len())?;
    let bodies = picture::bodies(cast, frame, &hits);
    let picture = Picture::draw(&bodies);
    file.write(|out| picture.write_png(out))?;
    Ok(Drawn {
        file: args.picture.picture.clone().unwrap_or_default(),
        frame,
        touching_triangles: picture::touching_triangles(&bodies),
    })
}
