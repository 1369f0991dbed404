//! What surfaces are drawn with at the end of a frame, and after its steps.

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;

use super::teleport::PhysicsSurface;
use crate::posing::drawn_weights;

/// Runs after the steps of a frame. If weights changed after the last step saw them, a fixed schedule animates them.
pub(crate) fn after_steps<S: PhysicsSurface>(
    mut surfaces: Query<(&mut S, Option<&MeshMorphWeights>)>,
    shared: Query<&MorphWeights>,
    mut rest: Local<Vec<f32>>,
) {
    for (mut surface, weights) in &mut surfaces {
        let following = surface.following();
        let count = following.before.pose.weights().len();
        if let Ok(weights) = drawn_weights(count, weights, &shared, &mut rest) {
            following.drawn.weights.after_steps(&weights.to_vec());
        }
    }
}

/// Runs at the end of a frame, when entities are where they are drawn: remembers where the last step left surfaces on bodies.
pub(crate) fn remember_places<S: PhysicsSurface>(mut surfaces: Query<(&mut S, &GlobalTransform)>) {
    for (mut surface, place) in &mut surfaces {
        surface.following().drawn.stop_at(place.affine());
    }
}
