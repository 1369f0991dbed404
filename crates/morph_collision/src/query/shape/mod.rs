//! Queries for a body against points, convex regions, balls, capsules, cuboids and half-spaces.
//!
//! All shapes are convex and are defined by the *signed distance* of a point: positive outside, zero on the surface and negative
//! inside. It is a convex function, the maximum of `w . x - support(w)` over all unit vectors `w`, so any direction gives a lower bound
//! for a node (`bound`). A triangle's signed distance is the minimum over its points.

mod batch;
mod bound;
mod cast;
mod closest;
mod cuboid;
mod pair;
mod placed;
mod point;
mod query;
mod region;

pub use cast::{ShapeCastHit, ShapeImpact};
pub use pair::ShapeGap;
pub use placed::{PlacedShape, Shape};
pub use point::ClosestPoint;
pub use query::{ShapeContact, ShapeQuery};
