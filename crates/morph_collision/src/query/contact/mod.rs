//! Where two bodies touch: a contact per pair of intersecting triangles, and what they come to together.

mod manifold;
mod parting;
mod query;

pub use manifold::{ContactPoint, Manifold};
pub use query::{ContactQuery, PairContact, Separation};
