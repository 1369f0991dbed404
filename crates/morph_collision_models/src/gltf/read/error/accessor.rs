//! What can be wrong with an accessor.

use super::{BufferProblem, CompressionFault, Remedy};
use crate::gltf::read::document::ElementError;
use crate::text::Printable;

/// Why an accessor cannot be decoded.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum AccessorProblem {
    /// There is no such accessor, or it is malformed.
    #[error("accessor {accessor} {problem}")]
    Element {
        /// The accessor's index.
        accessor: usize,
        /// The problem.
        problem: ElementError,
    },
    /// It refers to a buffer view that does not exist or is malformed.
    #[error("accessor {accessor} refers to buffer view {view}, which {problem}")]
    View {
        /// The accessor's index.
        accessor: usize,
        /// The view's index.
        view: usize,
        /// The problem with the view.
        problem: ElementError,
    },
    /// Its buffer cannot be loaded.
    #[error("accessor {accessor}: {problem}")]
    Buffer {
        /// The accessor's index.
        accessor: usize,
        /// The buffer's index and problem.
        problem: Box<BufferProblem>,
    },
    /// Its buffer view is compressed and cannot be decoded.
    #[error("accessor {accessor} needs buffer view {view}, which cannot be decoded: {fault}")]
    Compressed {
        /// The accessor's index.
        accessor: usize,
        /// The view's index.
        view: usize,
        /// Why it cannot be decoded.
        fault: Box<CompressionFault>,
    },
    /// A compressed primitive has more or fewer vertices than the accessor.
    #[error("accessor {accessor} has {expected} elements, but the compressed data has {found}")]
    DecodedCount {
        /// The accessor's index.
        accessor: usize,
        /// The number of decoded vertices.
        found: usize,
        /// The accessor's number of elements.
        expected: usize,
    },
    /// Its component type and shape are not allowed here.
    #[error("accessor {accessor} holds {} where {expected} is needed", Printable(found))]
    Type {
        /// The accessor's index.
        accessor: usize,
        /// What it holds.
        found: String,
        /// What is needed.
        expected: &'static str,
    },
    /// Its elements reach beyond its buffer view, or the view beyond its buffer.
    #[error("accessor {accessor} reaches beyond its buffer")]
    OutOfBounds {
        /// The accessor's index.
        accessor: usize,
    },
    /// Its stride is smaller than one element.
    #[error("accessor {accessor} has elements of {size} bytes every {stride} bytes")]
    Stride {
        /// The accessor's index.
        accessor: usize,
        /// Bytes per element.
        size: usize,
        /// Bytes from one element to the next.
        stride: usize,
    },
    /// A sparse accessor replaces an element that does not exist.
    #[error("accessor {accessor} replaces element {element} of {count}")]
    SparseIndex {
        /// The accessor's index.
        accessor: usize,
        /// The element it replaces.
        element: usize,
        /// Its number of elements.
        count: usize,
    },
}

impl AccessorProblem {
    pub(in crate::gltf::read) fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::Element { problem, .. } | Self::View { problem, .. } => problem.remedy(),
            Self::Buffer { problem, .. } => problem.fault.remedy(),
            Self::Compressed { fault, .. } => fault.remedy(),
            Self::Type { .. }
            | Self::OutOfBounds { .. }
            | Self::Stride { .. }
            | Self::SparseIndex { .. }
            | Self::DecodedCount { .. } => None,
        }
    }
}
