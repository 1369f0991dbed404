//! Spatial queries: systems ask about colliders, in world space.
//!
//! - `query`: [`MorphSpatialQuery`]. `walker`: its walk over colliders. `filter`: which of them. `answer`: what queries return.
//! - `casters`: components that cast a ray or a shape in every run.
//! - `rays`, `shapes`, `points`, `overlaps`, `pairs`, `posed`, `velocity`: the questions. `batches`: many of them at one moment.
//! - `index`: a tree over the boxes of all colliders. `state`: what queries share. `target`: a collider as a query sees it. `surface`: texture coordinates and joints of a hit.

mod answer;
mod batches;
mod casters;
mod filter;
mod index;
mod moving_shapes;
mod overlaps;
mod pairs;
mod points;
mod posed;
mod query;
mod rays;
mod shapes;
mod state;
mod surface;
mod target;
mod velocity;
mod walker;

use bevy::prelude::*;

pub use answer::{MorphClosestPoints, MorphManifold, MorphMotionHit, MorphProjection, MorphRayHit, MorphShapeHit};
pub(crate) use casters::casters;
pub use casters::{MorphRayCaster, MorphRayHits, MorphShapeCaster, MorphShapeHits};
pub use filter::MorphQueryFilter;
pub use moving_shapes::MorphShapeMotion;
pub use query::MorphSpatialQuery;
use state::SpatialState;

/// Adds the state of queries, and registers the types for reflection.
pub(crate) fn add(app: &mut App) {
    app.init_resource::<SpatialState>()
        .register_type::<MorphRayHit>()
        .register_type::<MorphProjection>()
        .register_type::<MorphShapeHit>()
        .register_type::<MorphMotionHit>()
        .register_type::<MorphShapeMotion>()
        .register_type::<MorphClosestPoints>()
        .register_type::<MorphManifold>()
        .register_type::<MorphQueryFilter>()
        .register_type::<MorphRayCaster>()
        .register_type::<MorphRayHits>()
        .register_type::<MorphShapeCaster>()
        .register_type::<MorphShapeHits>();
}
