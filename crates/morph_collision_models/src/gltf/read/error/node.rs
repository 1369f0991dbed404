//! What can be wrong with a node.

use super::{AccessorProblem, Remedy};
use crate::gltf::read::document::ElementError;
use crate::memory::OverBudget;

/// A problem with a node that shows a mesh.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum NodeProblem {
    /// The node's JSON is missing or malformed.
    #[error("it {0}")]
    Element(ElementError),
    /// An extension that says how it shows its mesh is malformed.
    #[error("an extension of it {0}")]
    Extension(ElementError),
    /// An instance has no place.
    #[error("{attribute} of its instance {instance} is not finite")]
    NotFinite {
        /// What is not finite.
        attribute: &'static str,
        /// The instance.
        instance: usize,
    },
    /// What places its instances cannot be decoded.
    #[error("{attribute} of its instances: {problem}")]
    Instances {
        /// What the accessor holds.
        attribute: &'static str,
        /// Why it cannot be decoded.
        problem: AccessorProblem,
    },
    /// The attributes of its instances have different lengths.
    #[error("its instances have {found} elements of {attribute}, but {expected} of {first}")]
    InstanceCount {
        /// The attribute.
        attribute: &'static str,
        /// Its number of elements.
        found: usize,
        /// An earlier attribute.
        first: &'static str,
        /// The number of elements of that.
        expected: usize,
    },
    /// It would take more memory than the file may.
    #[error(transparent)]
    OverBudget(OverBudget),
}

impl NodeProblem {
    pub(super) fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget(_) => Some(Remedy::MoreMemory),
            Self::Element(problem) | Self::Extension(problem) => problem.remedy(),
            Self::Instances { problem, .. } => problem.remedy(),
            Self::InstanceCount { .. } | Self::NotFinite { .. } => None,
        }
    }
}
