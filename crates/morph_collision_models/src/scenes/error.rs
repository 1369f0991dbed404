//! Errors of scene files.

use std::path::PathBuf;

use crate::gltf::read::{LFS_POINTER, Remedy};
use crate::memory::{Bytes, OverBudget};

/// Why a scene could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file is not a regular file.
    #[error("{}: not a regular file", path.display())]
    NotRegular {
        /// The file.
        path: PathBuf,
    },
    /// The file is longer than the memory limit allows.
    #[error("{}: it is longer than {}, the most that it may take", path.display(), Bytes(*.most))]
    TooLong {
        /// The file.
        path: PathBuf,
        /// The limit in bytes.
        most: u64,
    },
    /// The scene exceeds the memory limit.
    #[error("{}: {over}", path.display())]
    OverBudget {
        /// The file.
        path: PathBuf,
        /// The memory that it would take.
        over: OverBudget,
    },
    /// The file is a pointer that Git LFS leaves in place of one that was not fetched.
    #[error("{}: {LFS_POINTER}", path.display())]
    LfsPointer {
        /// The file.
        path: PathBuf,
    },
    /// The file is not JSON, or not that of a scene; the message ends with line and column.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The expected input and the place.
        source: serde_json::Error,
    },
    /// A frame does not place every body.
    #[error("{}: frame {frame} places {found} bodies, but there are {expected}", path.display())]
    FrameLength {
        /// The file.
        path: PathBuf,
        /// The frame's index.
        frame: usize,
        /// Number of bodies that it places.
        found: usize,
        /// Number of bodies in the scene.
        expected: usize,
    },
    /// A number is not finite in `f32`.
    #[error("{}: frame {frame}, body {body}: {what} {index} is {value}, which is not a finite number", path.display())]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// The frame's index.
        frame: usize,
        /// The body's index.
        body: usize,
        /// The list of numbers.
        what: &'static str,
        /// The index in that list.
        index: usize,
        /// The number.
        value: f32,
    },
    /// A rotation is not a unit quaternion.
    #[error("{}: frame {frame}, body {body}: the rotation has length {length}, which should be 1", path.display())]
    Rotation {
        /// The file.
        path: PathBuf,
        /// The frame's index.
        frame: usize,
        /// The body's index.
        body: usize,
        /// The quaternion's length.
        length: f32,
    },
}

impl SceneError {
    /// The option that would let the file through, if a limit or a rule of the reader refused it.
    pub fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget { .. } | Self::TooLong { .. } => Some(Remedy::MoreMemory),
            Self::NotRegular { .. } => Some(Remedy::AnyPath),
            Self::Io { .. }
            | Self::LfsPointer { .. }
            | Self::Json { .. }
            | Self::FrameLength { .. }
            | Self::NotFinite { .. }
            | Self::Rotation { .. } => None,
        }
    }
}
