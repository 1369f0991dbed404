//! The program `morph-collide`: try collision detection on morphing and skinned glTF models without writing a program.
//!
//! It is a library so that the same code runs where there is no command line: [`lint::Lint`] checks a model in memory, for a web page. **Its API may
//! change in any release.** The commands:
//!
//! - `inspect` shows what models are made of and what tree each mesh gets.
//! - `query` asks about one mesh in one shape.
//! - `sweep` plays clips and reports what touches.
//! - `lint` finds the weights with which a mesh runs into itself.
//! - `export` writes posed meshes with the triangles that touch in red.
//! - `scene` makes a scene file from models.
//! - `run` replays a scene and reports which triangles intersect, where bodies touch, or how far apart they are.
//! - `motion` replays a scene and reports when bodies first touch between frames.
//! - `verify` compares a model's answers with brute force.
//! - `stress` does the same with generated, difficult meshes.
//! - `bench` measures the library against other methods.
//! - `completions` and `man` print help for shells and for `man`.
//!
//! Results go to stdout, errors and progress to stderr. The exit code is 2 after an error, and 1 if `verify`, `stress` or `bench`
//! found something wrong, or `lint` or `sweep --fail-on-touch` something that touches.
#![forbid(unsafe_code)]

mod bench;
mod blame;
mod cast;
mod clip_files;
mod clips;
mod depth;
mod drawn_args;
mod error;
mod export;
mod expression;
mod frame_times;
mod guides;
mod help;
mod inspect;
mod left_out;
pub mod lint;
mod methods;
mod model_file;
mod motion;
mod output;
mod output_file;
mod paper_options;
mod picture;
mod posed;
mod progress;
mod query;
mod run;
mod scene;
mod shape_args;
mod stress;
mod sweep;
mod told_clips;
mod touching;
mod tree_options;
mod verify;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

pub use crate::progress::{Listener, Told, listen};

use crate::error::CliError;
use crate::progress::ProgressArgs;

/// Exact collision detection for glTF models with morph targets and joints.
///
/// Results go to standard output, errors and progress to standard error. The exit code is 2 after an error, and 1 if `verify`, `stress`
/// or `bench` finds a wrong answer, or `lint` or `sweep --fail-on-touch` something that touches.
#[derive(Debug, Parser)]
#[command(name = "morph-collide", version)]
struct Cli {
    #[command(flatten)]
    progress: ProgressArgs,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Inspect(inspect::InspectArgs),
    Query(query::QueryArgs),
    Sweep(sweep::SweepArgs),
    Lint(lint::LintArgs),
    Export(export::ExportArgs),
    Scene(scene::SceneArgs),
    Run(run::RunArgs),
    Motion(motion::MotionArgs),
    Verify(verify::VerifyArgs),
    Stress(stress::StressArgs),
    Bench(bench::BenchArgs),
    Completions(guides::CompletionsArgs),
    Man(guides::ManArgs),
}

/// The outcome of a command that ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// Nothing is wrong.
    Clean,
    /// An answer is wrong, or something touches that must not.
    FoundWrong,
}

/// Runs the program with the arguments of this process.
#[must_use]
pub fn run_program() -> ExitCode {
    let matches = help::wrapped(Cli::command()).try_get_matches();
    let cli = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => {
            output::complain_at_length(error.render());
            return ExitCode::from(2);
        }
        // `--help` and `--version` end up here. If the reader is gone, nobody needs the output.
        Err(help) => {
            let _ = help.print();
            return ExitCode::SUCCESS;
        }
    };
    cli.progress.start();
    let clean = |()| Verdict::Clean;
    let result = match &cli.command {
        Command::Inspect(args) => inspect::inspect(args).map(clean),
        Command::Query(args) => query::query(args).map(clean),
        Command::Sweep(args) => sweep::sweep(args),
        Command::Lint(args) => lint::lint(args),
        Command::Export(args) => export::export(args).map(clean),
        Command::Scene(args) => scene::scene(args).map(clean),
        Command::Run(args) => run::run(args).map(clean),
        Command::Motion(args) => motion::motion(args).map(clean),
        Command::Verify(args) => verify::verify(args),
        Command::Stress(args) => stress::stress(args),
        Command::Bench(args) => bench::bench(args),
        Command::Completions(args) => guides::completions(args).map(clean),
        Command::Man(args) => guides::man(args).map(clean),
    };
    match result {
        Ok(Verdict::Clean) => ExitCode::SUCCESS,
        Ok(Verdict::FoundWrong) => ExitCode::FAILURE,
        Err(CliError::Stdout(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            output::complain(format_args!("error: {error}"));
            ExitCode::from(2)
        }
    }
}
