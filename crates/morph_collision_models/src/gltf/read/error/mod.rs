//! Errors in a file, each with its place in the file.

mod accessor;
mod animation;
mod buffer;
mod compression;
mod mesh;
mod node;
mod skin;

use std::path::PathBuf;

use super::document::ElementError;
use crate::memory::{Bytes, OverBudget};
use crate::text::Printable;

pub use self::accessor::AccessorProblem;
pub use self::animation::AnimationProblem;
pub use self::buffer::{BufferFault, BufferProblem};
pub use self::compression::CompressionFault;
pub use self::mesh::MeshProblem;
pub use self::node::NodeProblem;
pub use self::skin::SkinProblem;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file itself could not be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// Neither a `.glb` container nor glTF JSON.
    #[error("{}: not a glTF 2.0 file: {reason}", path.display())]
    NotGltf {
        /// The file.
        path: PathBuf,
        /// What was found instead.
        reason: String,
    },
    /// The file needs an extension that might change its geometry.
    #[error(
        "{}: requires the glTF extension {}, which this reader does not know; export the model again without it, or undo it with a converter such as gltf-transform",
        path.display(),
        Printable(extension)
    )]
    Extension {
        /// The file.
        path: PathBuf,
        /// The extension's name.
        extension: String,
    },
    /// The file is not a regular file.
    #[error("{}: not a regular file", path.display())]
    NotRegular {
        /// The file.
        path: PathBuf,
    },
    /// A stream is longer than the memory limit allows, or the file grew while it was read.
    #[error("{}: it is longer than {}, the most that it may take", path.display(), Bytes(*.most))]
    TooLong {
        /// The file.
        path: PathBuf,
        /// The limit in bytes.
        most: u64,
    },
    /// The file as a whole exceeds the memory limit.
    #[error("{}: {over}", path.display())]
    OverBudget {
        /// The file.
        path: PathBuf,
        /// The part that exceeds the limit.
        over: OverBudget,
    },
    /// A mesh is broken.
    #[error("{}: mesh {mesh} \"{}\": {problem}", path.display(), Printable(name))]
    Mesh {
        /// The file.
        path: PathBuf,
        /// The mesh's index in the file.
        mesh: usize,
        /// The mesh's name, or its default name.
        name: String,
        /// The problem.
        problem: Box<MeshProblem>,
    },
    /// A mesh's skin is broken.
    #[error("{}: the skin of mesh {mesh} \"{}\": {problem}", path.display(), Printable(name))]
    Skin {
        /// The file.
        path: PathBuf,
        /// The mesh's index in the file.
        mesh: usize,
        /// The mesh's name, or its default name.
        name: String,
        /// The problem.
        problem: Box<SkinProblem>,
    },
    /// A scene is broken.
    #[error("{}: scene {scene} {problem}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// The scene's index in the file.
        scene: usize,
        /// The problem.
        problem: ElementError,
    },
    /// A node that shows a mesh is broken.
    #[error("{}: node {node} \"{}\": {problem}", path.display(), Printable(name))]
    Node {
        /// The file.
        path: PathBuf,
        /// The node's index in the file.
        node: usize,
        /// The node's name, or its default name.
        name: String,
        /// The problem.
        problem: Box<NodeProblem>,
    },
    /// An animation is broken.
    #[error("{}: animation {animation} \"{}\": {problem}", path.display(), Printable(name))]
    Animation {
        /// The file.
        path: PathBuf,
        /// The animation's index in the file.
        animation: usize,
        /// The animation's name, or its default name.
        name: String,
        /// The problem.
        problem: Box<AnimationProblem>,
    },
}

/// The option that lets a refused file through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// A larger [`ReadOptions::memory_limit`](super::ReadOptions).
    MoreMemory,
    /// [`ReadOptions::any_path`](super::ReadOptions).
    AnyPath,
    /// [`ReadOptions::skip_bad`](super::ReadOptions).
    SkipBad,
}

impl Remedy {
    /// The end of a message: the option of `morph-collide` that lets the file through.
    pub fn hint(remedy: Option<Self>) -> &'static str {
        match remedy {
            None => "",
            Some(Self::MoreMemory) => "; --memory-limit raises it",
            Some(Self::AnyPath) => "; pass --allow-any-path to read it",
            Some(Self::SkipBad) => "; --skip-bad leaves out what is bad",
        }
    }
}

impl ReadError {
    /// The option that would let the file through, if a limit or a rule of the reader refused it.
    pub fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget { .. } | Self::TooLong { .. } => Some(Remedy::MoreMemory),
            Self::NotRegular { .. } => Some(Remedy::AnyPath),
            Self::Mesh { problem, .. } => problem.remedy(),
            Self::Animation { problem, .. } => problem.remedy(),
            Self::Skin { problem, .. } => problem.remedy(),
            Self::Node { problem, .. } => problem.remedy(),
            Self::Scene { problem, .. } => problem.remedy(),
            Self::Io { .. } | Self::NotGltf { .. } | Self::Extension { .. } => None,
        }
    }
}

impl ElementError {
    fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget(_) => Some(Remedy::MoreMemory),
            Self::Missing | Self::Malformed(_) => None,
        }
    }
}
