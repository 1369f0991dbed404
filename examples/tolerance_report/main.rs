//! Rewrites the table and the plot of docs/tolerance.md in place: how much time a tolerance saves, and how large the error is.
//!
//! `--help` lists the options; `just tolerance-report` runs it.

mod follower;
mod stage;
mod table;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use morph_collision_testkit::bench::cpu;
use morph_collision_workspace::outcome::exit_code;
use morph_collision_workspace::tables::{Section, TableOptions, rewrite};

/// Time against error for colliders with a tolerance.
#[derive(Parser)]
struct Options {
    /// The page to rewrite. Plots go to the folder `plots` beside it.
    #[arg(default_value = "docs/tolerance.md")]
    page: PathBuf,
    #[command(flatten)]
    tables: TableOptions,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<(), String> {
    let quick = options.tables.quick;
    let plots = options.page.with_file_name("plots");
    let sections: [Section<'_>; 2] = [
        ("machine", Box::new(|| Ok(format!("{}\n", cpu())))),
        ("time-and-error", Box::new(move || table::make(quick, &plots))),
    ];
    rewrite(&options.page, &options.tables, &sections)
}
