//! `morph-lab stress`: tries the library on generated, difficult meshes.

mod report;

use clap::Args;
use morph_collision_cli::shared::{AnyError, Verdict, count, print, print_json};
use morph_collision_testkit::stress::{Family, Silence, stress as try_all};

use report::StressReport;

/// Compare this library's answers about generated, difficult meshes with brute force in exact arithmetic.
///
/// Every family of meshes is a row of the table, and the cases of a family use trees of several leaf sizes in turn. Columns: intersecting
/// `pairs` that brute force finds, pairs `missed` by the trees, `spurious` pairs that only the trees find, vertices `outside` their boxes,
/// `errors` for bad input that name it, `unexpected` results (bad input that was accepted, or good input that was refused), `panics`, and
/// the `slowdown` of the slowest case compared with an ordinary one that has as many intersecting pairs.
///
/// The last line says whether all answers agree. The exit code is 1 if an answer differs, bad input gets through, anything panics, or
/// nothing was compared.
#[derive(Debug, Args)]
pub(crate) struct StressArgs {
    /// Number of cases in every family.
    #[arg(long, value_name = "N", default_value_t = 200)]
    cases: u64,
    /// Random seed; the same seed gives the same cases.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Print one JSON object instead of a table.
    #[arg(long)]
    json: bool,
}

/// Tries all families and reports.
pub(crate) fn stress(args: &StressArgs) -> Result<Verdict, AnyError> {
    let steps = count("case", args.cases.saturating_mul(Family::ALL.len() as u64));
    let silence = Silence::new();
    let families = try_all(args.cases, args.seed, || steps.step());
    drop(silence);
    let report = StressReport::new(args.seed, &families);
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.text())?;
    }
    Ok(report.verdict())
}
