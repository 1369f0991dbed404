//! `morph-collide run`: replay a scene of scripted bodies and report which triangles meet.
//!
//! ```text
//! scene.json --bodies--> bodies of a method --replay--> hits and times per frame --report, pairs_csv--> stdout, OUT.csv
//! ```

mod bodies;
mod options;
mod pairs_csv;
mod replay;
mod report;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use morph_collision_testkit::rivals::Wanted;
use morph_collision_testkit::scenes::Scene;

use crate::error::CliError;
use crate::output;
use bodies::Cast;
use options::MethodArgs;
use pairs_csv::PairsFile;
use report::RunReport;

/// Replay a scene frame by frame and report which bodies and triangles meet.
///
/// A scene is a JSON file that names its bodies, {"model":"a.glb","mesh":0} with the path relative to the scene, and for every
/// frame gives each body's "weights", "scale", "rotation" (a quaternion x,y,z,w) and "translation".
#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// The scene file.
    scene: PathBuf,
    /// How much to find out about two bodies.
    #[arg(long, value_enum, default_value_t = Mode::All)]
    mode: Mode,
    #[command(flatten)]
    how: MethodArgs,
    /// Write the pairs to a CSV file: `frame,body_a,body_b,triangle_a,triangle_b`.
    ///
    /// With the modes `first` and `any` one line per pair of bodies that touch.
    #[arg(long, value_name = "OUT.csv")]
    pairs: Option<PathBuf>,
    /// Print one JSON object instead of a summary.
    #[arg(long)]
    json: bool,
}

/// How much to find out about two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Mode {
    /// Every pair of triangles that meet.
    All,
    /// One pair of triangles that meet.
    First,
    /// Only whether any triangles meet.
    Any,
}

impl Mode {
    fn wanted(self) -> Wanted {
        match self {
            Self::All => Wanted::All,
            Self::First | Self::Any => Wanted::First,
        }
    }
}

/// Loads, replays and reports a scene. Times leave loading and writing out.
pub(crate) fn run(args: &RunArgs) -> Result<(), CliError> {
    let scene = Scene::read(&args.scene)?;
    let mut cast = Cast::load(&args.scene, &scene, &args.how)?;
    // Opened before the work, so that a path that cannot be written costs no replay.
    let pairs_file = args.pairs.as_deref().map(PairsFile::create).transpose()?;

    let replay = replay::replay(&mut cast, args.mode, pairs_file.is_some())?;

    if let Some(file) = pairs_file {
        file.write(&replay.hits)?;
    }
    let report = RunReport::new(&replay, cast.bodies, args.mode, args.how.method());
    if args.json {
        output::print_json(&report)
    } else {
        output::print(&report.summary())
    }
}
