//! What can go wrong in the laboratory beside what can go wrong in the tool.

use std::path::PathBuf;

use morph_collision_testkit::moments::AnswerError;
use morph_collision_testkit::rivals::PoseError;
use thiserror::Error;

/// Why a command failed.
#[derive(Debug, Error)]
pub(crate) enum LabError {
    /// A situation drawn for `verify` that the mesh does not allow because its coordinates are too large.
    #[error("{}: mesh {mesh} \"{name}\": {reason}", file.display())]
    Situation {
        file: PathBuf,
        mesh: usize,
        name: String,
        reason: PoseError,
    },
    /// A scene of `bench`: a model's file or a scene's name.
    #[error("{scene}: {reason}")]
    Bench { scene: String, reason: AnswerError },
}
