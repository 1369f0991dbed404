//! What `--skip-bad` leaves out of meshes, for all JSON.

use std::sync::{Mutex, PoisonError};

use morph_collision_models::left_out::LeftOut;
use serde::Serialize;

/// What was left out of a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct LeftOutOfMesh {
    pub(crate) file: String,
    pub(crate) mesh: usize,
    pub(crate) name: String,
    #[serde(flatten)]
    pub(crate) left_out: LeftOut,
}

/// What was left out of all meshes so far.
static ALL: Mutex<Vec<LeftOutOfMesh>> = Mutex::new(Vec::new());

/// Adds what was left out of a mesh. Returns whether it was not known yet.
pub(crate) fn add(found: &LeftOutOfMesh) -> bool {
    let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    let is_news = !all.contains(found);
    if is_news {
        all.push(found.clone());
    }
    is_news
}

/// What was left out of all meshes so far.
pub(crate) fn all() -> Vec<LeftOutOfMesh> {
    ALL.lock().unwrap_or_else(PoisonError::into_inner).clone()
}
