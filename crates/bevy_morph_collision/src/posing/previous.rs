//! Remembers the previous state of meshes, and the time between the last two runs.

use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::state::{ColliderState, Form, LockedPose, MorphCollisionDiagnostics, RunTimes, Runs};

/// Begins a run: saves the current state of every mesh as its previous state.
///
/// Costs one copy of the weights per collider.
pub(crate) fn remember_previous(
    mut colliders: Query<&mut ColliderState>,
    runs: Res<Runs>,
    time: Option<Res<Time>>,
    mut times: ResMut<RunTimes>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    times.begin_run(time.map(|time| time.elapsed()));
    for mut state in &mut colliders {
        let state = &mut *state;
        // While its entity was disabled, its state was not updated.
        let placed = state.placed.as_ref().filter(|_| state.freshness.is_seen(&runs));
        state.previous.world_from_model = match placed.map(|placed| &placed.form) {
            Some(Form::Mesh(world_from_model)) => Some(*world_from_model),
            _ => None,
        };
        if let (Some(_), Some(pose)) = (
            state.previous.world_from_model,
            state.pose.as_mut().map(LockedPose::get_mut),
        ) {
            state.previous.shape.take(pose);
        }
    }
    diagnostics.duration += start.elapsed();
}
