//! The state of a collider's mesh after a run.

use morph_collision::{PoseSnapshot, WorldFromModel};

/// The state of a collider's mesh after a run.
#[derive(Clone, Default)]
pub(crate) struct Previous {
    pub(crate) shape: PoseSnapshot,
    /// `None` if it took no part.
    pub(crate) world_from_model: Option<WorldFromModel>,
}
