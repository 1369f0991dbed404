//! The program `morph-collide`: try collision detection on morphing and skinned glTF models without writing a program.
//!
//! It is a library so that the same code runs where there is no command line: [`lint::Lint`] checks a model in memory, for a web page, and
//! [`bake::Trees`] bakes one, for tests. **Its API may
//! change in any release.** The commands:
//!
//! - `inspect` shows what models are made of and what tree each mesh gets.
//! - `query` asks about one mesh in one shape.
//! - `sweep` plays clips and reports what touches.
//! - `lint` finds the weights with which a mesh runs into itself.
//! - `bake` writes the trees of a model's meshes to a file that a game loads.
//! - `export` writes posed meshes with the triangles that touch in red.
//! - `scene` makes a scene file from models.
//! - `run` replays a scene and reports which triangles intersect, where bodies touch, or how far apart they are.
//! - `motion` replays a scene and reports when bodies first touch between frames.
//! - `completions` and `man` print help for shells and for `man`.
//!
//! Results go to stdout, errors and progress to stderr. The exit code is 2 after an error, and 1 if `lint` or `sweep --fail-on-touch` found
//! something that touches.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! shared > bake, export, lint, sweep > guides, inspect, motion, query, run, scene > touching > cast > options, output > files
//! > messages > error, help, picture
//! ```
#![forbid(unsafe_code)]

pub mod bake;
mod cast;
mod error;
mod export;
mod files;
mod guides;
mod help;
mod inspect;
pub mod lint;
mod messages;
mod motion;
mod options;
mod output;
mod picture;
mod query;
mod run;
mod scene;
mod sweep;
mod touching;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

pub use crate::messages::progress::{Listener, Message, listen};

use crate::error::{AnyError, CliError};
use crate::messages::progress::ProgressArgs;

/// What `morph-lab`, the program of the test kit, shares with this one: how files are read, bodies are set up, and results are written.
pub mod shared {
    pub use crate::cast::{SetUp, Shape, Source};
    pub use crate::error::{AnyError, CliError};
    pub use crate::files::clips::read_clips;
    pub use crate::files::model::{FileArgs, MeshChoice, count_memory, leave_out_unweighted, read_mesh};
    pub use crate::messages::progress::{ProgressArgs, Steps, count, doing};
    pub use crate::messages::{complain, counted};
    pub use crate::options::tree::TreeArgs;
    pub use crate::output::{print, print_json};
    pub use crate::run::{Mode, PairFinder, RunArgs, run, run_with};
    pub use crate::{Verdict, run_cli};
}

/// Exact collision detection for glTF models with morph targets and joints.
///
/// Results go to standard output, errors and progress to standard error. The exit code is 2 after an error, and 1 if `lint` or
/// `sweep --fail-on-touch` finds something that touches.
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
    Bake(bake::BakeArgs),
    Scene(scene::SceneArgs),
    Run(run::RunArgs),
    Motion(motion::MotionArgs),
    Completions(guides::CompletionsArgs),
    Man(guides::ManArgs),
}

/// The outcome of a command that ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing is wrong.
    Clean,
    /// An answer is wrong, or something touches that must not.
    FoundWrong,
}

/// Runs the program with the arguments of this process.
#[must_use]
pub fn run_program() -> ExitCode {
    run_cli(|cli: &Cli| {
        cli.progress.start();
        Ok(run_command(&cli.command)?)
    })
}

fn run_command(command: &Command) -> Result<Verdict, CliError> {
    let clean = |()| Verdict::Clean;
    match command {
        Command::Inspect(args) => inspect::inspect(args).map(clean),
        Command::Query(args) => query::query(args).map(clean),
        Command::Sweep(args) => sweep::sweep(args),
        Command::Lint(args) => lint::lint(args),
        Command::Bake(args) => bake::bake(args).map(clean),
        Command::Export(args) => export::export(args).map(clean),
        Command::Scene(args) => scene::scene(args).map(clean),
        Command::Run(args) => run::run(args).map(clean),
        Command::Motion(args) => motion::motion(args).map(clean),
        Command::Completions(args) => guides::completions(args).map(clean),
        Command::Man(args) => guides::man(args).map(clean),
    }
}

/// Parses the arguments of this process and runs a command. Writes errors to stderr, after the program's name, and returns the exit code.
pub fn run_cli<C: CommandFactory + FromArgMatches>(run: impl FnOnce(&C) -> Result<Verdict, AnyError>) -> ExitCode {
    let command = C::command();
    messages::set_program(command.get_name());
    let matches = help::wrapped(command).try_get_matches();
    let cli = match matches.and_then(|matches| C::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => {
            messages::complain_at_length(error.render());
            return ExitCode::from(2);
        }
        // `--help` and `--version` end up here. If the reader is gone, nobody needs the output.
        Err(help) => {
            let _ = help.print();
            return ExitCode::SUCCESS;
        }
    };
    let error = match run(&cli) {
        Ok(Verdict::Clean) => return ExitCode::SUCCESS,
        Ok(Verdict::FoundWrong) => return ExitCode::FAILURE,
        Err(error) => error,
    };
    if let Some(CliError::Stdout(reason)) = error.downcast_ref()
        && reason.kind() == std::io::ErrorKind::BrokenPipe
    {
        return ExitCode::SUCCESS;
    }
    messages::complain(format_args!("error: {error}"));
    ExitCode::from(2)
}
