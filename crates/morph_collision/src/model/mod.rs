//! The immutable mesh: welded base positions, sparse displacements, influences of joints, triangles, and the map from source
//! to welded vertices. Vertices are kept in blocks of eight (`blocks`), which are posed side by side (`posing`).

mod bad_parts;
mod blocks;
mod check;
mod displacements;
mod error;
mod influence_rows;
mod influences;
mod morph_model;
mod posing;
mod skin;
mod targets;
mod vertex_order;
mod weight_box;
mod weights;
mod weld;

pub use bad_parts::BadParts;
pub(crate) use blocks::{BLOCK, block_and_lane};
pub(crate) use check::LARGEST;
pub(crate) use displacements::Displacement;
pub use error::ModelError;
pub use influences::Influences;
pub use morph_model::MorphModel;
pub(crate) use posing::{BlendedBlock, PlacedBlock};
pub(crate) use skin::{Skin, sum_rounding};
pub use targets::{SparseTarget, TargetDisplacements};
pub use weight_box::WeightBox;
pub(crate) use weights::Weights;

#[cfg(test)]
mod posing_tests;
#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod tests;
