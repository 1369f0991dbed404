//! Culling: the `Aabb` of deforming meshes.
//!
//! - `plugin`: [`MorphBoundsPlugin`] and its systems. `culled`: the meshes that it cares for.
//! - `drawn`: boxes around meshes as they are drawn. `changes`: whether they may have to change. `local`: boxes in the space of an entity.

mod changes;
mod culled;
mod drawn;
mod local;
mod plugin;

pub use plugin::{MorphBoundsPlugin, MorphBoundsSystems};
