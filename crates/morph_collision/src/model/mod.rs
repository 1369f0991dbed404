//! The immutable mesh: base shape, sparse displacements, triangles, and the way back to the user's indices.

mod check;
mod error;
mod morph_model;
mod weld;

pub use error::{ModelError, Subject};
pub use morph_model::MorphModel;
pub(crate) use morph_model::{Displacement, LARGEST};

#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod tests;
