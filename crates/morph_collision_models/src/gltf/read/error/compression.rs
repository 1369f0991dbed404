//! What can be wrong with compressed data.

use super::{BufferProblem, Remedy};
use crate::gltf::read::document::ElementError;
use crate::memory::OverBudget;

/// Why compressed data cannot be decoded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompressionFault {
    /// The buffer with the compressed data cannot be loaded.
    #[error(transparent)]
    Buffer(Box<BufferProblem>),
    /// The view with the compressed data is missing or malformed.
    #[error("it {0}")]
    View(ElementError),
    /// The extension that says how it is compressed is malformed.
    #[error("its extension {0}")]
    Extension(ElementError),
    /// There is no such buffer view.
    #[error("it does not exist")]
    NoView,
    /// The compressed data reaches beyond its buffer, or decoded data is too short.
    #[error("the compressed data reaches beyond its buffer")]
    OutOfBounds,
    /// The data is not what meshoptimizer writes, or its layout in the file is wrong.
    #[error("the meshopt decoder says: {0}")]
    Meshopt(String),
    /// The data is not what Draco writes, or it has more elements than the file says.
    #[error("the Draco decoder says: {0}")]
    Draco(String),
    /// The decoded data lacks an attribute.
    #[error("the compressed data has no attribute {0}")]
    NoAttribute(usize),
    /// An attribute holds numbers of a type that glTF does not have.
    #[error("attribute {0} of the compressed data has a component type that glTF does not have")]
    ComponentType(usize),
    /// The decoded data would take more memory than the file may.
    #[error(transparent)]
    OverBudget(OverBudget),
}

impl CompressionFault {
    /// Whether it could be decoded if there were more memory.
    pub(in crate::gltf::read) fn is_lack_of_memory(&self) -> bool {
        self.remedy() == Some(Remedy::MoreMemory)
    }

    pub(super) fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget(_) => Some(Remedy::MoreMemory),
            Self::Buffer(problem) => problem.fault.remedy(),
            Self::View(problem) | Self::Extension(problem) => problem.remedy(),
            _ => None,
        }
    }
}
