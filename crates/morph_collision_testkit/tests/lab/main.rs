//! Drives the `morph-lab` binary as its users do: passes files and checks its output and exit code.

mod bench;
mod help;
mod run;
mod stress;
#[path = "../../../morph_collision_cli/tests/cli/support/mod.rs"]
#[allow(dead_code, reason = "the tests of the tool use more of it")]
mod support;
mod verify;

/// The program, as it names itself in messages, and its file.
const PROGRAM: &str = "morph-lab";
const PROGRAM_FILE: &str = env!("CARGO_BIN_EXE_morph-lab");
