//! Schedules of Bevy.

use bevy::app::{FixedFirst, FixedLast, FixedPostUpdate, FixedPreUpdate, FixedUpdate};
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};

/// Whether a schedule runs once per fixed time step.
#[must_use]
pub fn is_fixed(schedule: InternedScheduleLabel) -> bool {
    let fixed = [
        FixedFirst.intern(),
        FixedPreUpdate.intern(),
        FixedUpdate.intern(),
        FixedPostUpdate.intern(),
        FixedLast.intern(),
    ];
    fixed.contains(&schedule)
}
