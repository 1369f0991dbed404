//! Culling: the `Aabb` of deforming meshes.
//!
//! - `plugin`: [`MorphBoundsPlugin`] and its systems. `culled`: the meshes that it cares for.
//! - `drawn`: boxes around meshes as they are drawn. `local`: boxes in the space of an entity.

mod culled;
mod drawn;
mod local;
mod plugin;

pub use plugin::{MorphBoundsPlugin, MorphBoundsSystems};
