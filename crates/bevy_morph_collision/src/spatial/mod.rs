//! Spatial queries: systems ask about colliders, in world space.

mod answer;
mod filter;
mod index;
mod overlaps;
mod pairs;
mod points;
mod posed;
mod query;
mod rays;
mod shapes;
mod state;
mod surface;
mod velocity;

pub use answer::{MorphClosestPoints, MorphManifold, MorphProjection, MorphRayHit, MorphShapeHit};
pub use filter::MorphQueryFilter;
pub use query::MorphSpatialQuery;
pub(crate) use state::SpatialState;
