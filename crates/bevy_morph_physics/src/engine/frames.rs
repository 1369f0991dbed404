//! What surfaces are drawn with at the end of a frame, and after its steps.

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;

use super::interface::Engine;
use super::surface::PhysicsSurface;
use crate::time::WeightSource;

/// Runs after the steps of a frame. If weights changed after the last step saw them, a fixed schedule animates them.
pub(super) fn after_steps<E: Engine>(
    mut surfaces: Query<(&mut PhysicsSurface<E>, Option<&MeshMorphWeights>)>,
    shared: Query<&'static MorphWeights>,
) {
    for (mut surface, component) in &mut surfaces {
        let weights = WeightSource {
            component,
            shared: &shared,
        };
        surface.moving.after_steps(&weights);
    }
}

/// Runs at the end of a frame, when entities are where they are drawn: records where the last step left surfaces on bodies.
pub fn record_transforms<E: Engine>(mut surfaces: Query<(&mut PhysicsSurface<E>, &GlobalTransform)>) {
    for (mut surface, transform) in &mut surfaces {
        surface.moving.drawn.stop_at(transform.affine());
    }
}
