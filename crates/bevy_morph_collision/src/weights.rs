//! From Bevy's morph weights to a pose's.

use bevy::platform::time::Instant;

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use morph_collision::Pose;
use tracing::{debug_span, error};

use crate::collider::{ColliderState, MorphCollider};
use crate::diagnostics::MorphCollisionDiagnostics;

/// Every pose takes the weights its mesh is drawn with.
///
/// Weights are compared by value: change detection fires every frame while an animation player exists. Without
/// [`MeshMorphWeights`] a mesh is drawn, and collides, in its rest pose. Weights that do not fit are logged once, until they
/// fit again, and the last good ones stay in force.
pub(crate) fn read_weights(
    mut colliders: Query<(Entity, &mut ColliderState, Option<&MeshMorphWeights>), With<MorphCollider>>,
    names: Query<NameOrEntity>,
    shared: Query<&MorphWeights>,
    mut rest: Local<Vec<f32>>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::weights").entered();
    for (entity, mut state, weights) in &mut colliders {
        let state = &mut *state;
        let Some(pose) = &mut state.pose else { continue };
        if pose.weights().is_empty() {
            continue;
        }
        match take_weights(pose, weights, &shared, &mut rest) {
            Ok(changed) => {
                state.bad_weights = false;
                state.reposed |= changed;
                state.changed |= changed;
            }
            Err(error) if !state.bad_weights => {
                state.bad_weights = true;
                let name = names.get(entity).map(|name| name.to_string()).unwrap_or_default();
                error!("morph weights of entity `{name}` cannot be used: {error}; the last good ones stay in force");
            }
            Err(_) => {}
        }
    }
    diagnostics.duration += start.elapsed();
}

/// Gives a pose the weights that its mesh is drawn with; says whether they are others than before, or what is wrong with them.
pub(crate) fn take_weights(
    pose: &mut Pose,
    weights: Option<&MeshMorphWeights>,
    shared: &Query<&MorphWeights>,
    rest: &mut Vec<f32>,
) -> Result<bool, String> {
    let given = match weights {
        Some(MeshMorphWeights::Value { weights }) => weights.as_slice(),
        Some(&MeshMorphWeights::Reference(source)) => match shared.get(source) {
            Ok(weights) => weights.weights(),
            Err(_) => return Err(format!("entity {source}, which it refers to, has no MorphWeights")),
        },
        None => {
            rest.clear();
            rest.resize(pose.weights().len(), 0.0);
            rest
        }
    };
    pose.set_weights(given).map_err(|error| error.to_string())
}
