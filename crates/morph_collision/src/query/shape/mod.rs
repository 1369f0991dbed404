//! Queries for a body against points, convex regions and shapes.
//!
//! A shape is one convex solid or several. A solid is a half-space, or everything within a radius of a `core`.
//!
//! A solid is defined by the *signed distance* of a point: positive outside, zero on the surface and negative inside. It is a convex
//! function, the maximum of `w . x - support(w)` over all unit vectors `w`, so any direction gives a lower bound for a node (`bound`). A
//! triangle's signed distance is the minimum over its points.

mod batch;
mod bound;
mod cast;
mod closest;
mod core;
mod first_touch;
mod hull;
mod kinds;
mod moving;
mod moving_cast;
mod pair;
mod placed;
mod point;
mod query;
mod region;
mod solid;

pub use cast::{ShapeCastHit, ShapeImpact};
pub(super) use first_touch::first_touch_of_triangle;
pub use hull::{ConvexHull, HullError};
pub use kinds::Shape;
pub use moving::MovingShape;
pub use moving_cast::SurfaceImpact;
pub use pair::{MovingShapeImpact, ShapeGap};
pub use placed::PlacedShape;
pub use point::ClosestPoint;
pub use query::{ShapeContact, ShapeQuery};
