//! `morph-collide motion`: replay a scene and report when bodies first touch between one frame and the next.
//!
//! ```text
//! scene.json --Cast--> poses at both ends of a step --steps--> first contacts --report--> stdout
//! ```

mod report;
mod steps;

use std::path::PathBuf;

use clap::Args;
use morph_collision_testkit::scenes::Scene;

use crate::cast::Cast;
use crate::error::CliError;
use crate::model_file::FileArgs;
use crate::output;
use crate::progress::ProgressArgs;
use crate::tree_options::TreeArgs;
use report::MotionReport;
use steps::Stage;

/// Replay a scene and report when bodies first touch between two frames.
///
/// Between two frames, every vertex moves on a straight line. Contacts during that motion are found however fast bodies move, and
/// nothing is reported that does not touch. Scenes are those of `run`.
#[derive(Debug, Args)]
pub(crate) struct MotionArgs {
    /// The scene file.
    scene: PathBuf,
    /// The largest difference between the two ends of a reported time, as a share of a step: more than 0, at most 1.
    #[arg(long, value_name = "SHARE", default_value_t = 1e-6, value_parser = parse_tolerance)]
    tolerance: f64,
    /// Also count every pair of features that touch: vertices and faces, edges and edges. Triangles that cross each other all the time
    /// need not have such pairs.
    #[arg(long)]
    count: bool,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    files: FileArgs,
    #[command(flatten)]
    progress: ProgressArgs,
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
    let scene = Scene::read_within(&args.scene, args.files.memory_limit())?;
    let mut cast = Cast::load(&args.scene, &scene, &args.tree, &args.files)?;
    let steps = cast.frames.len().saturating_sub(1);
    let progress = args.progress.start("step", steps as u64);
    let mut stage = Stage::new(args.tolerance, args.count);
    for step in 0..steps {
        stage.step(&mut cast, step)?;
        progress.step();
    }
    progress.finish();
    let report = MotionReport::new(steps, cast.bodies, stage);
    if args.json {
        output::print_json(&report)
    } else {
        output::print(&report.summary())
    }
}
