//! What can be wrong with a scene file.

use std::path::PathBuf;

use crate::memory::OverBudget;

/// Why a scene could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The scene would take more memory than a file may.
    #[error("{}: {over}", path.display())]
    OverBudget {
        /// The file.
        path: PathBuf,
        /// How much it would take.
        over: OverBudget,
    },
    /// Not JSON, or not the JSON of a scene; the reason ends with line and column.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What was expected, and where.
        source: serde_json::Error,
    },
    /// A frame does not place every body.
    #[error("{}: frame {frame} places {found} bodies, but there are {expected}", path.display())]
    FrameLength {
        /// The file.
        path: PathBuf,
        /// The frame's index.
        frame: usize,
        /// How many bodies it places.
        found: usize,
        /// How many bodies there are.
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
        /// Which list of numbers.
        what: &'static str,
        /// The place in that list.
        index: usize,
        /// The number.
        value: f32,
    },
    /// A rotation is no rotation.
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
