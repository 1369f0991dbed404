//! Runs the program, and writes small input files for it. The tests of `morph-lab` use it, too.
//!
//! The crate of the tests names its program as `PROGRAM`, and the file of it as `PROGRAM_FILE`.

mod models;
mod scenes;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub(crate) use models::{RawMesh, bound_and_free, write_gltf};
pub(crate) use scenes::{mixed_scene, write_scene};

/// An error of the test itself fails it with the error's message.
pub(crate) type TestResult = Result<(), Box<dyn Error>>;

/// `assets/` at the root of the repository.
pub(crate) fn asset(path: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets")).join(path)
}

/// The small models of the tool's tests.
pub(crate) fn data(path: &str) -> PathBuf {
    Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../morph_collision_cli/tests/data"
    ))
    .join(path)
}

/// A file of the reader's tests that shows one habit of exporters.
pub(crate) fn field(name: &str) -> PathBuf {
    let field = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../morph_collision_models/tests/gltf/data/field"
    );
    Path::new(field).join(name)
}

/// A command that runs the program.
pub(crate) fn command() -> Command {
    Command::new(crate::PROGRAM_FILE)
}

/// Runs the program to its end.
pub(crate) fn run_program<S: AsRef<std::ffi::OsStr>>(
    args: impl IntoIterator<Item = S>,
) -> Result<Output, Box<dyn Error>> {
    Ok(command().args(args).output()?)
}

/// A run's stderr without progress lines; slow machines print more of those.
fn complaints_of(output: &Output) -> String {
    let stderr = String::from_utf8_lossy(&output.stderr);
    let lines = stderr.split_inclusive('\n');
    let progress = format!("{}: progress: ", crate::PROGRAM);
    lines.filter(|line| !line.starts_with(&progress)).collect()
}

/// The stdout of a run that must have succeeded without a complaint.
pub(crate) fn stdout_of(output: &Output) -> String {
    let stderr = complaints_of(output);
    assert!(
        output.status.success() && stderr.is_empty(),
        "{:?}: {stderr}",
        output.status
    );
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The complaint of a run that must have failed: exit code 2 and one line that starts with the
/// program's name.
pub(crate) fn error_of(output: &Output) -> String {
    let stderr = complaints_of(output);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    let error = format!("{}: error: ", crate::PROGRAM);
    assert!(stderr.starts_with(&error), "{stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    stderr
}
