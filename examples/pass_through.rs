//! Two morphing bodies pass right through each other, and where they touch is red. This is the first experiment of the paper on
//! which this project is based.
//!
//! `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use morph_collision_workspace::{options::ViewOptions, shows, view};

/// Two morphing bodies pass right through each other, and where they touch is red: the first experiment of the paper on which
/// this project is based.
#[derive(Parser)]
struct Options {
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    view::main(shows::pass_through(), &Options::parse().view)
}
