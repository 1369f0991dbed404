//! Tells what `--skip-bad` leaves out of meshes: in a line on stderr, and in all JSON.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use morph_collision_testkit::left_out::LeftOut;
use morph_collision_testkit::printable::Printable;
use serde::Serialize;

use crate::output;

/// What was left out of a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct LeftOutOfMesh {
    file: String,
    mesh: usize,
    name: String,
    #[serde(flatten)]
    left_out: LeftOut,
}

/// What was left out of all meshes so far.
static ALL: Mutex<Vec<LeftOutOfMesh>> = Mutex::new(Vec::new());

/// Says what was left out of a mesh, once.
pub(crate) fn tell(file: &Path, mesh: usize, name: &str, left_out: LeftOut) {
    let told = LeftOutOfMesh {
        file: file.display().to_string(),
        mesh,
        name: name.to_owned(),
        left_out,
    };
    let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    if all.contains(&told) {
        return;
    }
    output::complain(format_args!(
        "warning: {}: mesh {mesh} \"{}\": {}",
        told.file,
        Printable(&told.name),
        told.left_out
    ));
    all.push(told);
}

/// What was left out of all meshes so far.
pub(crate) fn all() -> Vec<LeftOutOfMesh> {
    ALL.lock().unwrap_or_else(PoisonError::into_inner).clone()
}
