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

pub(super) fn run_checks(world: &mut World) {
    let checks = world.remove_resource::<LaterChecks>().unwrap_or_default();
    for check in checks.0 {
        check(world);
    }
}
