//! Questions about colliders, asked by systems: world space in, world space out.

mod answer;
mod filter;
mod overlaps;
mod points;
mod query;
mod rays;
mod surface;
mod velocity;

pub use answer::{MorphClosestPoints, MorphContacts, MorphProjection, MorphRayHit};
pub use filter::MorphQueryFilter;
pub use query::MorphSpatialQuery;
