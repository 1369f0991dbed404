//! The times of the last runs.

use std::time::Duration;

use bevy::prelude::*;

/// The times of the last runs.
#[derive(Resource, Clone, Copy, Default)]
pub(crate) struct RunTimes {
    last: Option<Duration>,
    /// The time between the last two runs.
    pub(crate) between: Option<Duration>,
}

impl RunTimes {
    /// Begins a run at a time of the app's clock; `None` without a clock.
    pub(crate) fn begin_run(&mut self, now: Option<Duration>) {
        self.between = now.zip(self.last).map(|(now, last)| now.saturating_sub(last));
        self.last = now;
    }
}
