//! Shows the changes of fixed runs to the systems of the frame around them.

use crate::app::is_fixed;
use crate::contacts::MorphCollisions;
use crate::state::Runs;
use bevy::ecs::schedule::InternedScheduleLabel;
use bevy::prelude::*;

/// If the schedule is a fixed one, shows the changes to the systems around it, too.
pub(crate) fn show_fixed_runs_to_frames(app: &mut App, schedule: InternedScheduleLabel) {
    if !is_fixed(schedule) {
        return;
    }
    app.world_mut().resource_mut::<MorphCollisions>().changes.set_fixed();
    app.add_systems(
        RunFixedMainLoop,
        (
            show_run
                .after(RunFixedMainLoopSystems::BeforeFixedMainLoop)
                .before(RunFixedMainLoopSystems::FixedMainLoop),
            show_frame
                .after(RunFixedMainLoopSystems::FixedMainLoop)
                .before(RunFixedMainLoopSystems::AfterFixedMainLoop),
        ),
    );
}

/// Systems in fixed schedules continue to see the last run, which may have been several frames ago.
fn show_run(mut collisions: ResMut<MorphCollisions>) {
    collisions.bypass_change_detection().changes.show_run();
}

/// Systems in the rest of the frame see the changes of the whole frame.
fn show_frame(mut collisions: ResMut<MorphCollisions>) {
    collisions.bypass_change_detection().changes.show_frame();
}

/// While the plugin is paused, nothing starts or ends, and motion does not count.
pub(crate) fn begin_empty_run(mut collisions: ResMut<MorphCollisions>, mut runs: ResMut<Runs>) {
    collisions.bypass_change_detection().begin_run();
    runs.interrupt();
}
