//! One instance: its weights, and what has been blended for them so far.
//!
//! A node's volume comes from one place, [`Posed::open`]: blended from tables (`blend`) or fitted to vertices, kept by
//! stamp (`cache`). Weights that rest can be given tight volumes (`anchor`).

mod anchor;
mod approximate;
mod blend;
mod cache;
mod containment;
mod instance;
mod posed;
mod quality;
mod refit;
mod shape;
mod visit;
mod weights;

pub use approximate::{Approximate, ApproximatePose};
pub use containment::{ContainmentReport, ContainmentViolation};
pub use instance::Pose;
pub(crate) use posed::{AnyPosed, Blended, NodeRef, Place, Posed, with_posed};
pub use quality::TreeQuality;
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
