//! Remembers the previous state of meshes, and the time between the last two runs.

use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::app::MorphCollisionSystems;
use crate::state::{ColliderNews, ColliderState, Form, LockedPose, MorphCollisionDiagnostics, Moved, RunTimes, Runs};

/// Begins a run: saves the current state of every mesh as its previous state.
///
/// Costs one copy of the weights per collider that changed in the last run.
pub(crate) fn remember_previous(
    mut colliders: Query<&mut ColliderState>,
    mut news: ResMut<ColliderNews>,
    runs: Res<Runs>,
    time: Option<Res<Time>>,
    mut times: ResMut<RunTimes>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    times.begin_run(time.map(|time| time.elapsed()));
    match std::mem::take(&mut news.moved) {
        Moved::All => colliders.iter_mut().for_each(|mut state| remember(&mut state, &runs)),
        Moved::Some(moved) => {
            for collider in moved {
                if let Ok(mut state) = colliders.get_mut(collider) {
                    remember(&mut state, &runs);
                }
            }
        }
    }
    diagnostics.spend(MorphCollisionSystems::Weights, start.elapsed());
}

fn remember(state: &mut ColliderState, runs: &Runs) {
    // While its entity was disabled, its state was not updated.
    let placed = state.placed.as_ref().filter(|_| state.freshness.is_seen(runs));
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
