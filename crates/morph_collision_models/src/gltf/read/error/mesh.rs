//! What can be wrong with a mesh.

use super::{AccessorProblem, CompressionFault, Remedy};
use crate::gltf::read::document::ElementError;
use crate::memory::OverBudget;

/// A problem with a mesh.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum MeshProblem {
    /// The mesh's JSON is missing or malformed.
    #[error("it {0}")]
    Element(ElementError),
    /// It would take more memory than the file may.
    #[error(transparent)]
    OverBudget(OverBudget),
    /// A primitive has no positions.
    #[error("primitive {primitive} has no POSITION attribute")]
    MissingPositions {
        /// The primitive's index in the mesh.
        primitive: usize,
    },
    /// A primitive's mode is not one that glTF defines.
    #[error("primitive {primitive} has an unknown mode")]
    UnknownMode {
        /// The primitive's index in the mesh.
        primitive: usize,
    },
    /// An accessor cannot be decoded.
    #[error("primitive {primitive}, {attribute}: {problem}")]
    Accessor {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// What the accessor holds.
        attribute: String,
        /// Why it cannot be decoded.
        problem: AccessorProblem,
    },
    /// A compressed primitive cannot be decoded.
    #[error("primitive {primitive} cannot be decoded: {fault}")]
    Compressed {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// Why it cannot be decoded.
        fault: CompressionFault,
    },
    /// The number of default weights is not that of the targets.
    #[error("it has {found} default weights for {expected} targets")]
    DefaultWeights {
        /// The number of default weights.
        found: usize,
        /// The number of targets.
        expected: usize,
    },
    /// A default weight is not finite.
    #[error("the default weight of target {target} is {weight}, which is not finite")]
    DefaultWeight {
        /// The target's index.
        target: usize,
        /// The weight.
        weight: f32,
    },
    /// Primitives of a mesh have different numbers of targets. They share weights, so the numbers
    /// must be equal.
    #[error("primitive {primitive} has {found} morph targets, but primitive 0 has {expected}")]
    TargetCount {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// Its number of targets.
        found: usize,
        /// The number of targets of the first primitive.
        expected: usize,
    },
    /// A target has more or fewer displacements than there are vertices.
    #[error("primitive {primitive}, target {target} has {found} displacements for {expected} vertices")]
    TargetLength {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// The target's index.
        target: usize,
        /// Its number of displacements.
        found: usize,
        /// The number of vertices.
        expected: usize,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("primitive {primitive}, index {position} refers to vertex {vertex} of {vertices}")]
    VertexOutOfRange {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// The place in the primitive's list of indices.
        position: usize,
        /// The vertex named there.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A list of separate triangles ends in the middle of one.
    #[error("primitive {primitive} has {corners} triangle corners, which is no multiple of 3")]
    IncompleteTriangle {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// The number of corners.
        corners: usize,
    },
    /// More vertices or triangles than 32 bits can number.
    #[error("primitive {primitive} takes the mesh beyond 2^32 vertices or triangles")]
    TooLarge {
        /// The primitive's index in the mesh.
        primitive: usize,
    },
}

impl MeshProblem {
    pub(super) fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget(_) => Some(Remedy::MoreMemory),
            Self::Element(problem) => problem.remedy(),
            Self::Accessor { problem, .. } => problem.remedy(),
            Self::Compressed { fault, .. } => fault.remedy(),
            Self::TargetCount { .. }
            | Self::TargetLength { .. }
            | Self::VertexOutOfRange { .. }
            | Self::IncompleteTriangle { .. } => Some(Remedy::SkipBad),
            _ => None,
        }
    }
}
