//! Contacts of two bodies: one per pair of intersecting triangles, and a manifold that summarises them.

mod manifold;
mod parting;
mod query;

pub use manifold::{ContactPoint, Manifold};
pub use query::ContactQuery;
pub(super) use query::outward_triangle;
