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
    view::main(shows::culling(), &Options::parse().view)
}
