//! What can be wrong with a skin.

use super::{AccessorProblem, MeshProblem, Remedy};
use crate::gltf::read::document::ElementError;
use crate::memory::OverBudget;

/// A problem with the skin of a mesh.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum SkinProblem {
    /// The mesh itself cannot be read.
    #[error(transparent)]
    Mesh(MeshProblem),
    /// The skin's JSON is missing or malformed.
    #[error("skin {skin} {problem}")]
    Element {
        /// The skin's index in the file.
        skin: usize,
        /// The problem.
        problem: ElementError,
    },
    /// A node's JSON is missing or malformed.
    #[error("node {node} {problem}")]
    Node {
        /// The node's index in the file.
        node: usize,
        /// The problem.
        problem: ElementError,
    },
    /// A node is below itself.
    #[error("node {node} is its own ancestor")]
    Cycle {
        /// The node's index in the file.
        node: usize,
    },
    /// The inverse bind matrices cannot be decoded.
    #[error("inverse bind matrices: {0}")]
    InverseBind(AccessorProblem),
    /// There are fewer inverse bind matrices than joints.
    #[error("skin {skin} has {found} inverse bind matrices for {joints} joints")]
    MatrixCount {
        /// The skin's index in the file.
        skin: usize,
        /// The number of matrices.
        found: usize,
        /// The number of joints.
        joints: usize,
    },
    /// A primitive of a skinned mesh has no influences.
    #[error("primitive {primitive} has no {attribute} attribute, and the mesh is skinned")]
    MissingInfluences {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// What is missing.
        attribute: String,
    },
    /// Influences cannot be decoded.
    #[error("primitive {primitive}, {attribute}: {problem}")]
    Accessor {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// What the accessor holds.
        attribute: String,
        /// Why it cannot be decoded.
        problem: AccessorProblem,
    },
    /// There are more or fewer influences than vertices.
    #[error("primitive {primitive}, {attribute} has {found} entries for {expected} vertices")]
    Length {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// What the accessor holds.
        attribute: String,
        /// Its number of entries.
        found: usize,
        /// The number of vertices.
        expected: usize,
    },
    /// It would take more memory than the file may.
    #[error(transparent)]
    OverBudget(OverBudget),
}

impl SkinProblem {
    pub(super) fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget(_) => Some(Remedy::MoreMemory),
            Self::Element { problem, .. } | Self::Node { problem, .. } => problem.remedy(),
            Self::Mesh(problem) => problem.remedy(),
            Self::InverseBind(problem) | Self::Accessor { problem, .. } => problem.remedy(),
            _ => None,
        }
    }
}
