//! The stages of a run.

use bevy::prelude::*;

/// The stages of the plugin, in order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphCollisionSystems {
    /// Finds new colliders and builds the trees of their meshes. Always in [`PostUpdate`].
    Import,
    /// Reads the current morph weights and joint matrices.
    Weights,
    /// Places colliders in the world and finds the pairs whose boxes overlap.
    BroadPhase,
    /// Finds the triangles that intersect.
    NarrowPhase,
    /// Reports what started and ended.
    Events,
    /// Casts the rays and shapes of [`MorphRayCaster`](crate::spatial::MorphRayCaster) and
    /// [`MorphShapeCaster`](crate::spatial::MorphShapeCaster).
    Casters,
    /// Moves anchored entities to their place on the drawn surface. Always in [`PostUpdate`], even while paused.
    Anchors,
}
