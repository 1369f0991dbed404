//! The boxes that Bevy uses to cull morphing meshes, next to those of this project.
//!
//! `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use morph_collision_workspace::{options::ViewOptions, shows, view};

/// The boxes that Bevy uses to cull morphing meshes, next to those of this project.
#[derive(Parser)]
struct Options {
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    view::main(shows::culling(), &Options::parse().view)
}
