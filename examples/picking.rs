//! Morphing models under the pointer: picking hits exactly what is drawn.
//!
//! `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use morph_collision_workspace::{options::ViewOptions, shows, view};

/// Morphing models under the pointer: picking hits exactly what is drawn.
#[derive(Parser)]
struct Options {
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    view::main(shows::picking(), &Options::parse().view)
}
