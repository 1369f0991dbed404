//! `morph-collide motion`: replay a scene and report when bodies first touch between one frame and the next.
//!
//! ```text
//! scene.json --Cast--> poses at both ends of a step --steps--> first contacts --report--> stdout
//! ```

mod report;
mod steps;

use std::path::PathBuf;

use clap::Args;

use crate::cast::Cast;
use crate::error::CliError;
use crate::files::model::FileArgs;
use crate::messages::progress;
use crate::options::tree::TreeArgs;
use crate::output;
use report::MotionReport;
use steps::{Ends, Stage};

const EXAMPLES: &str = "Examples:
  morph-collide motion scene.json
  morph-collide scene body.glb sword.glb --place 0,0,0 --place x=-2..2 --frames 5 | morph-collide motion -";

/// Replay a scene and report when bodies first touch between one frame and the next.
///
/// Between two frames, every vertex moves in a straight line. All contacts during that motion are found, however fast the bodies move,
/// and nothing is reported that does not touch. `run` tests only the frames themselves. docs/scene.md describes scene files.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct MotionArgs {
    /// A scene file; - reads it from standard input.
    scene: PathBuf,
    /// Accuracy of the reported times, as a share of the step between two frames: more than 0, at most 1.
    #[arg(long, value_name = "SHARE", default_value_t = 1e-6, value_parser = parse_tolerance)]
    tolerance: f64,
    /// Also count all contacts of a step: pairs of a vertex and a face, or of two edges, that touch. Triangles that intersect during the
    /// whole step may have none.
    #[arg(long)]
    count: bool,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of a summary.
    #[arg(long)]
    json: bool,
}

fn parse_tolerance(text: &str) -> Result<f64, String> {
    let tolerance: f64 = text.parse().map_err(|_| format!("{text} is not a number"))?;
    if tolerance > 0.0 && tolerance <= 1.0 {
        Ok(tolerance)
    } else {
        Err("it must be more than 0 and at most 1".to_owned())
    }
}

/// Loads, replays and reports a scene.
pub(crate) fn motion(args: &MotionArgs) -> Result<(), CliError> {
    let budget = args.files.budget();
    let scene = args.files.read_scene(&args.scene, &budget)?;
    let mut cast = Cast::load(&args.scene, &scene, &Ends(&args.tree), &args.files, &budget)?;
    let steps = cast.frames.len().saturating_sub(1);
    let progress = progress::count("step", steps as u64);
    let mut stage = Stage::new(args.tolerance, args.count);
    for step in 0..steps {
        stage.step(&mut cast, step)?;
        progress.step();
    }
    let report = MotionReport::new(steps, cast.bodies, stage);
    if args.json {
        output::print_json(&report)
    } else {
        output::print(&report.summary())
    }
}
