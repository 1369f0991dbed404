//! Remembers the previous state of meshes, and the time between the last two runs.

use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::{PoseSnapshot, WorldFromModel};

use crate::broad_phase::Candidates;
use crate::collider::{ColliderState, Form, LockedPose};
use crate::diagnostics::MorphCollisionDiagnostics;

/// The state of a collider's mesh after a run.
#[derive(Default)]
pub(crate) struct Before {
    pub(crate) shape: PoseSnapshot,
    /// `None` if it took no part.
    pub(crate) place: Option<WorldFromModel>,
}

/// The times of the last runs.
#[derive(Resource, Default)]
pub(crate) struct RunTimes {
    last: Option<Duration>,
    /// The time between the last two runs.
    pub(crate) between: Option<Duration>,
}

/// Begins a run: saves the current state of every mesh as its previous state.
///
/// Costs one copy of the weights per collider.
pub(crate) fn remember(
    mut colliders: Query<&mut ColliderState>,
    candidates: Res<Candidates>,
    time: Option<Res<Time>>,
    mut times: ResMut<RunTimes>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let now = time.map(|time| time.elapsed());
    times.between = now.zip(times.last).map(|(now, last)| now.saturating_sub(last));
    times.last = now;
    for mut state in &mut colliders {
        let state = &mut *state;
        // While its entity was disabled, its state was not updated.
        let placed = state.placed.as_ref().filter(|_| state.seen == candidates.run());
        state.before.place = match placed.map(|placed| &placed.form) {
            Some(Form::Mesh(place)) => Some(*place),
            _ => None,
        };
        if let (Some(_), Some(pose)) = (state.before.place, state.pose.as_mut().map(LockedPose::get_mut)) {
            state.before.shape.take(pose);
        }
    }
    diagnostics.duration += start.elapsed();
}
