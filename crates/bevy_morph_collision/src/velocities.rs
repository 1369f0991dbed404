//! What meshes were like in the run before the last one, and how long ago that was.

use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::{PoseSnapshot, WorldFromModel};

use crate::broad_phase::Candidates;
use crate::collider::{ColliderState, Form, LockedPose};
use crate::diagnostics::MorphCollisionDiagnostics;

/// A collider's mesh as a run left it.
#[derive(Default)]
pub(crate) struct Before {
    pub(crate) shape: PoseSnapshot,
    /// None if it took no part.
    pub(crate) place: Option<WorldFromModel>,
}

/// When the last runs were.
#[derive(Resource, Default)]
pub(crate) struct RunTimes {
    last: Option<Duration>,
    /// The time between the last two.
    pub(crate) between: Option<Duration>,
}

/// Begins a run: what every mesh is like now is what it was like before.
///
/// Costs a copy of its weights for each collider.
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
        // While its entity was disabled, nobody looked at it.
        let placed = state.placed.filter(|_| state.seen == candidates.run());
        state.before.place = match placed.map(|placed| placed.form) {
            Some(Form::Mesh(place)) => Some(place),
            _ => None,
        };
        if let (Some(_), Some(pose)) = (state.before.place, state.pose.as_mut().map(LockedPose::get_mut)) {
            state.before.shape.take(pose);
        }
    }
    diagnostics.duration += start.elapsed();
}
