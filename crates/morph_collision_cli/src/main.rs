//! `morph-collide`: try collision detection on morphing glTF models without writing a program.
//!
//! - `inspect` shows what a model is made of and what tree it gets.
//! - `run` replays a scene of scripted bodies and reports which triangles intersect.
//! - `motion` replays a scene and reports when bodies first touch between frames.
//! - `query` asks about one mesh in one shape.
//! - `verify` compares a model's answers with brute force.
//! - `stress` does the same with generated, difficult meshes.
//! - `bench` measures the library against other methods.
//!
//! Results go to stdout, errors and progress to stderr. The exit code is 2 after an error, and 1 if `verify`, `stress` or `bench`
//! found something wrong.
#![forbid(unsafe_code)]

mod bench;
mod cast;
mod error;
mod inspect;
mod model_file;
mod motion;
mod output;
mod output_file;
mod paper_options;
mod picture;
mod progress;
mod query;
mod run;
mod stress;
mod tree_options;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::CliError;

/// Inspect morphing glTF models and collide them.
#[derive(Debug, Parser)]
#[command(name = "morph-collide", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Inspect(inspect::InspectArgs),
    Run(run::RunArgs),
    Motion(motion::MotionArgs),
    Query(query::QueryArgs),
    Verify(verify::VerifyArgs),
    Stress(stress::StressArgs),
    Bench(bench::BenchArgs),
}

/// The outcome of a command that ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// Nothing is wrong.
    Clean,
    /// An answer is wrong.
    FoundWrong,
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
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
    let clean = |()| Verdict::Clean;
    let result = match &cli.command {
        Command::Inspect(args) => inspect::inspect(args).map(clean),
        Command::Run(args) => run::run(args).map(clean),
        Command::Motion(args) => motion::motion(args).map(clean),
        Command::Query(args) => query::query(args).map(clean),
        Command::Verify(args) => verify::verify(args),
        Command::Stress(args) => stress::stress(args),
        Command::Bench(args) => bench::bench(args),
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
