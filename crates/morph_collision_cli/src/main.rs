//! `morph-collide`. Everything is in the library, which other programs use, too.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    morph_collision_cli::run_program()
}
