//! `morph-collide`: try collision detection on morphing glTF models without writing a program.
//!
//! `inspect` shows what a model is made of and what tree it gets; `run` replays a scene of scripted bodies and reports
//! which triangles meet; `query` asks about one mesh in one shape. Results go to stdout, errors and progress to stderr; the
//! exit code is 2 after an error.
#![forbid(unsafe_code)]

mod error;
mod inspect;
mod output;
mod query;
mod run;

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
    Query(query::QueryArgs),
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => {
            output::complain(error.render());
            return ExitCode::from(2);
        }
        // `--help` and `--version` come this way; a reader that has gone away needs no answer.
        Err(help) => {
            let _ = help.print();
            return ExitCode::SUCCESS;
        }
    };
    let result = match &cli.command {
        Command::Inspect(args) => inspect::inspect(args),
        Command::Run(args) => run::run(args),
        Command::Query(args) => query::query(args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(CliError::Stdout(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            output::complain(format_args!("error: {error}"));
            ExitCode::from(2)
        }
    }
}
