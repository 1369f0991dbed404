//! Rewrites the tables of docs/characters.md in place: what a crowd of skinned characters costs and how accurate it is, with this
//! plugin, with Bevy's own bounds and picking, and with capsules in Rapier.
//!
//! `--help` lists the options; `just characters-report` runs it.

mod capsules;
mod culling;
mod picking;
mod stage;
mod touching;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use morph_collision_testkit::bench::cpu;
use morph_collision_workspace::outcome::exit_code;
use morph_collision_workspace::tables::{Section, TableOptions, rewrite};

/// Tables about crowds of skinned characters.
#[derive(Parser)]
struct Options {
    /// The page to rewrite.
    #[arg(default_value = "docs/characters.md")]
    page: PathBuf,
    #[command(flatten)]
    tables: TableOptions,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<(), String> {
    let quick = options.tables.quick;
    let sections: [Section<'_>; 8] = [
        ("machine", Box::new(|| Ok(format!("{}\n", cpu())))),
        ("contact-time", Box::new(move || touching::times(quick))),
        ("contact-answers", Box::new(move || touching::answers(quick))),
        ("picking-time", Box::new(move || picking::times(quick))),
        ("picking-answers", Box::new(move || picking::answers(quick))),
        ("bounds-size", Box::new(move || culling::sizes(quick))),
        ("bounds-turned", Box::new(move || culling::turned(quick))),
        ("bounds-time", Box::new(move || culling::times(quick))),
    ];
    rewrite(&options.page, &options.tables, &sections)
}
