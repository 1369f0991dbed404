//! `morph-collide stress`: tries the library on generated, difficult meshes.

mod report;

use clap::Args;
use morph_collision_testkit::stress::{Family, Silence, stress as try_all};

use crate::error::CliError;
use crate::progress::ProgressArgs;
use crate::{Verdict, output};
use report::StressReport;

/// Try the library on generated, difficult meshes, one row per family, with trees of several leaf sizes in turn.
///
/// Answers are compared with brute force in exact arithmetic, and boxes with the vertices they contain. Bad input must be refused
/// by an error that names it, and the previous good state must still give correct answers. `slowdown` is the slowest case's time
/// divided by that of an ordinary case with as many intersecting pairs.
///
/// The exit code is 1 if a pair is missed or made up, a vertex is outside its box, bad input gets through, or anything panics.
#[derive(Debug, Args)]
pub(crate) struct StressArgs {
    /// Number of cases in every family.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..))]
    cases: u64,
    /// Random seed; the same seed gives the same cases.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    progress: ProgressArgs,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    json: bool,
}

/// Tries all families and reports.
pub(crate) fn stress(args: &StressArgs) -> Result<Verdict, CliError> {
    let bar = args
        .progress
        .start("case", args.cases.saturating_mul(Family::ALL.len() as u64));
    let silence = Silence::new();
    let families = try_all(args.cases, args.seed, || bar.step());
    drop(silence);
    bar.finish();
    let report = StressReport::new(args.seed, &families);
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text())?;
    }
    Ok(report.verdict())
}
