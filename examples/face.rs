//! A face speaks. Places where jaw, lips, teeth and tongue intersect are red. Click to stick pins to the skin.
//!
//! `--help` lists the options.

use std::process::ExitCode;

use clap::Parser;
use morph_collision_workspace::{options::ViewOptions, shows, view};

/// A face speaks. Places where jaw, lips, teeth and tongue intersect are red. Click to stick pins to the skin.
#[derive(Parser)]
struct Options {
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    view::main(shows::face(), &Options::parse().view)
}
