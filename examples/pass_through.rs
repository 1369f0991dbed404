//! Two morphing bodies pass right through each other, and where they meet is red: the first experiment of the paper this project
//! starts from.
//!
//! `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use morph_collision_workspace::{options::ViewOptions, shows, view};

/// Two morphing bodies pass right through each other, and where they meet is red: the first experiment of the paper this project starts from.
#[derive(Parser)]
struct Options {
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    view::main(shows::pass_through(), &Options::parse().view)
}
