//! One instance: its weights, and what has been blended for them so far.
//!
//! A node's box comes from one place, [`Posed::open`]: blended from tables (`blend`) and kept by stamp (`cache`). Weights that
//! rest can be given tight boxes to blend from (`anchor`), and all boxes can be fitted to the vertices at once (`refit`).

mod anchor;
mod blend;
mod cache;
mod containment;
mod instance;
mod posed;
mod refit;
mod shape;
mod visit;
mod weights;

pub use containment::{ContainmentReport, ContainmentViolation};
pub use instance::Pose;
pub(crate) use posed::{Blended, NodeId, NodeRef, Posed};
pub use shape::NoSuchVertex;
pub use weights::WeightsError;

#[cfg(test)]
mod containment_tests;
#[cfg(test)]
mod corners_tests;
#[cfg(test)]
mod refit_tests;
#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod tests;
