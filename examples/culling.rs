//! What Bevy culls morphing meshes by, next to what this project makes of it.
//!
//! `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use morph_collision_workspace::{options::ViewOptions, shows, view};

/// What Bevy culls morphing meshes by, next to what this project makes of it.
#[derive(Parser)]
struct Options {
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    match view::run(shows::culling(), &Options::parse().view) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
