//! Your own model, twice: the copies run into each other, and the panel compares the cost with a refit of the whole mesh. Drop
//! other files on the window.
//!
//! `--help` lists the options.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use morph_collision_workspace::{options::ViewOptions, shows, view};

/// Two copies of a model run into each other; touching triangles are red.
#[derive(Parser)]
struct Options {
    /// A .glb file, or a self-contained .gltf file, that has morph targets.
    #[arg(default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/mh_head_eyes_teeth_arkit52.glb"))]
    model: PathBuf,
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let name = options.model.display().to_string();
    let inbox = shows::Inbox::default();
    match std::fs::read(&options.model) {
        Ok(bytes) => inbox.put(name, bytes),
        Err(error) => {
            eprintln!("error: {name}: {error}");
            return ExitCode::from(2);
        }
    }
    view::main(shows::own(inbox, shows::Verdict::default()), &options.view)
}
