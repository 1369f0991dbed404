//! The immutable mesh: welded base positions, sparse displacements, influences of joints, triangles, and the map from source
//! to welded vertices.

mod bad_parts;
mod check;
mod displacement;
mod error;
mod morph_model;
mod skin;
mod targets;
mod weight_box;
mod weights;
mod weld;

pub use bad_parts::BadParts;
pub(crate) use check::LARGEST;
pub(crate) use displacement::Displacement;
pub use error::ModelError;
pub use morph_model::MorphModel;
pub use skin::Influences;
pub(crate) use skin::{Skin, sum_rounding};
pub use targets::{SparseTarget, TargetDisplacements};
pub use weight_box::WeightBox;
pub(crate) use weights::Weights;

#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod tests;
