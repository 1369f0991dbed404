//! Drives the `morph-collide` binary as a user would: passes files and checks its output and exit
//! code.

mod bad_input;
mod bake;
mod bombs;
mod clip_files;
mod clips;
mod drawn;
mod export;
mod guides;
mod inspect;
mod lint;
mod lint_character;
mod lint_garment;
mod lint_sources;
mod motion;
mod outputs;
mod picture;
mod query;
mod run;
mod scene;
mod skins;
mod skip_bad;
mod support;
mod surface;
mod sweep;
mod thresholds;
mod unweighted;
mod weights;

/// The program, as it names itself in messages, and its file.
const PROGRAM: &str = "morph-collide";
const PROGRAM_FILE: &str = env!("CARGO_BIN_EXE_morph-collide");
