//! Answers that may be off, for less work: only if asked for, in types of their own, each with its bound.

mod answer;
mod limits;
mod query;
mod rule;

pub use answer::{ApproximatePairs, ApproximateTouch, MeshPart, PartPair};
pub use limits::Approximation;
pub use query::ApproximateQuery;
