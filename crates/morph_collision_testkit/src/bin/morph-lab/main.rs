//! `morph-lab`: compares the library with brute force and with other methods, measures it, and writes what the repository keeps of that.
//!
//! - `verify`, `stress`, `certificates`, `containment`, `determinism`, `motions`, `mutations`, `triangles`: are answers right?
//! - `bench`, `run`, `report`, `frames`, `steps`, `tightness`: how fast is it, beside other methods?
//! - `make-assets`: the models and scenes in `assets/`.
//!
//! The exit code is 2 after an error, and 1 if an answer is wrong.
#![forbid(unsafe_code)]

mod bench;
mod certificates;
mod containment;
mod determinism;
mod error;
mod frames;
mod make_assets;
mod methods;
mod motions;
mod mutations;
mod report;
mod run;
mod steps;
mod stress;
mod tightness;
mod triangles;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use morph_collision_cli::shared::{AnyError, ProgressArgs, Verdict, run_cli};

/// The laboratory: compares this library's answers with brute force, and its speed with other methods.
///
/// The exit code is 2 after an error, and 1 if an answer is wrong.
#[derive(Debug, Parser)]
#[command(name = "morph-lab", version)]
struct Cli {
    #[command(flatten)]
    progress: ProgressArgs,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Verify(verify::VerifyArgs),
    Stress(stress::StressArgs),
    Bench(bench::BenchArgs),
    #[command(about = run::ABOUT, long_about = run::LONG_ABOUT, after_help = run::EXAMPLES)]
    Run(run::LabRunArgs),
    Report(report::ReportArgs),
    Certificates(certificates::CertificatesArgs),
    Containment(containment::ContainmentArgs),
    Determinism(determinism::DeterminismArgs),
    Frames(frames::FramesArgs),
    MakeAssets(make_assets::MakeAssetsArgs),
    Motions(motions::MotionsArgs),
    Mutations(mutations::MutationsArgs),
    Steps(steps::StepsArgs),
    /// Measure how much larger the boxes of skinned models are than the smallest ones.
    Tightness,
    Triangles(triangles::TrianglesArgs),
}

fn main() -> ExitCode {
    run_cli(|cli: &Cli| {
        if matches!(
            cli.command,
            Command::Verify(_) | Command::Stress(_) | Command::Bench(_) | Command::Run(_) | Command::Determinism(_)
        ) {
            cli.progress.start();
        }
        run_command(&cli.command)
    })
}

fn run_command(command: &Command) -> Result<Verdict, AnyError> {
    match command {
        Command::Verify(args) => verify::verify(args),
        Command::Stress(args) => stress::stress(args),
        Command::Bench(args) => bench::bench(args),
        Command::Run(args) => run::run(args),
        Command::Report(args) => report::report(args),
        Command::Certificates(args) => certificates::certificates(args),
        Command::Containment(args) => containment::containment(args),
        Command::Determinism(args) => determinism::determinism(args),
        Command::Frames(args) => frames::frames(args),
        Command::MakeAssets(args) => make_assets::make_assets(args),
        Command::Motions(args) => motions::motions(args),
        Command::Mutations(args) => mutations::mutations(args),
        Command::Steps(args) => steps::steps(args),
        Command::Tightness => tightness::tightness(),
        Command::Triangles(args) => triangles::triangles(args),
    }
}

/// The verdict of a command that found something wrong, or not.
fn verdict(is_clean: bool) -> Verdict {
    if is_clean { Verdict::Clean } else { Verdict::FoundWrong }
}
