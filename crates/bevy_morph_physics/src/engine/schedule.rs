//! Where a physics engine steps, so that this plugin's systems run beside it.

use bevy::app::MainScheduleOrder;
use bevy::ecs::schedule::{InternedScheduleLabel, InternedSystemSet, NodeId, Schedule, Schedules, SystemSet};
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use bevy_morph_collision::physics_api::is_fixed;
use tracing::{error, warn};

use super::interface::EngineNames;

/// The schedules that have a system in a set.
pub fn schedules_with(app: &App, set: impl SystemSet) -> Vec<InternedScheduleLabel> {
    let set = set.intern();
    let Some(schedules) = app.world().get_resource::<Schedules>() else {
        return Vec::new();
    };
    let found = schedules.iter().filter(|(_, schedule)| has_system_in(schedule, set));
    let mut found: Vec<_> = found.map(|(_, schedule)| schedule.label()).collect();
    // In the same order in every run.
    found.sort_by_key(|label| format!("{label:?}"));
    found
}

fn has_system_in(schedule: &Schedule, set: InternedSystemSet) -> bool {
    let graph = schedule.graph();
    let Some(set) = graph.system_sets.get_key(set) else {
        return false;
    };
    let (mut open, mut seen) = (vec![NodeId::Set(set)], HashSet::new());
    while let Some(node) = open.pop() {
        if node.is_system() {
            return true;
        }
        if seen.insert(node) {
            open.extend(graph.hierarchy().graph().neighbors(node));
        }
    }
    false
}

/// Chooses the schedule for the systems of an engine's crate: the one in which the engine steps. If the game named another one, or if
/// the engine steps in several, the log says what to write.
pub(super) fn choose(
    found: &[InternedScheduleLabel],
    named: Option<InternedScheduleLabel>,
    names: &EngineNames,
) -> Option<InternedScheduleLabel> {
    if let Some(named) = named.filter(|named| found.contains(named)) {
        return Some(named);
    }
    let EngineNames {
        plugin, engine_plugin, ..
    } = names;
    match (found, named) {
        ([], named) => named,
        (&[one], None) => Some(one),
        (&[one], Some(named)) => {
            warn!(
                "{plugin}.in_schedule({named:?}) runs in {one:?}, because {engine_plugin} steps there: write {plugin} alone, which finds \
                 the schedule itself"
            );
            Some(one)
        }
        (several, _) => {
            error!(
                "{plugin} does nothing, because {engine_plugin} steps in several schedules: {several:?}; name the one with morphing meshes, \
                 for example {plugin}.in_schedule({:?})",
                several[0]
            );
            None
        }
    }
}

/// Whether a schedule runs once per fixed time step. `None` if only the first step will show, because the game runs the schedule
/// itself.
pub fn runs_fixed(app: &App, schedule: InternedScheduleLabel) -> Option<bool> {
    if is_fixed(schedule) {
        return Some(true);
    }
    let order = app.world().get_resource::<MainScheduleOrder>()?;
    order.labels.contains(&schedule).then_some(false)
}
