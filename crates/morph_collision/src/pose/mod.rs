//! One instance: its weights, and what has been blended for them so far.

mod blend;
mod cache;
mod instance;

pub(crate) use instance::NodeRef;
pub use instance::{Pose, WeightsError};

#[cfg(test)]
mod containment_tests;
#[cfg(test)]
mod tests;
