//! The immutable mesh: welded base positions, sparse displacements, triangles, and the map from source vertices.

mod check;
mod error;
mod morph_model;
mod weld;

pub use error::ModelError;
pub use morph_model::MorphModel;
pub(crate) use morph_model::{Displacement, LARGEST};

#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod tests;
