//! Checks of other crates that wait until all plugins are there.

use bevy::prelude::*;

/// Checks that wait for the next frame.
#[derive(Resource, Default)]
pub(super) struct LaterChecks(Vec<fn(&mut World)>);

/// Runs a check of what an app lacks in the next frame, or in the current one. By then, the app has all its plugins. Apps without
/// collision detection never run it.
pub fn check_in_next_frame(world: &mut World, check: fn(&mut World)) {
    world.get_resource_or_init::<LaterChecks>().0.push(check);
}

pub(super) fn are_waiting(checks: Option<Res<LaterChecks>>) -> bool {
    checks.is_some_and(|checks| !checks.0.is_empty())
}

pub(super) fn run_checks(mut commands: Commands, mut checks: ResMut<LaterChecks>) {
    for check in std::mem::take(&mut checks.0) {
        commands.queue(check);
    }
}
