//! When the steps of an engine are.

use bevy::prelude::*;

use super::clock::{Lag, Watch};

/// Whether the fixed schedules are running now.
#[derive(Resource, Default)]
pub struct InFixedLoop(pub bool);

/// Keeps [`InFixedLoop`] up to date.
pub fn track_fixed_loop(app: &mut App) {
    if app.world().contains_resource::<InFixedLoop>() {
        return;
    }
    let set = |now: bool| move |mut inside: ResMut<InFixedLoop>| inside.0 = now;
    app.init_resource::<InFixedLoop>()
        .add_systems(FixedFirst, set(true))
        .add_systems(
            RunFixedMainLoop,
            set(false)
                .after(RunFixedMainLoopSystems::FixedMainLoop)
                .before(RunFixedMainLoopSystems::AfterFixedMainLoop),
        );
}

/// When the steps of an engine are, and which moment of the drawn animation they use.
#[derive(Default)]
pub struct Timing {
    /// Whether physics runs in a fixed schedule.
    pub is_fixed: bool,
    /// Whether each step decides that.
    is_learning: bool,
    /// In that case, how far physics is behind what is drawn.
    pub lag: Lag,
    /// Watches the clock of physics.
    pub watch: Watch,
}

impl Timing {
    /// `None` if only the first step will show whether physics runs in a fixed schedule.
    pub fn new(is_fixed: Option<bool>) -> Self {
        Self {
            is_fixed: is_fixed.unwrap_or(false),
            is_learning: is_fixed.is_none(),
            ..Self::default()
        }
    }

    /// Runs before every step.
    pub fn learn(&mut self, inside: &InFixedLoop) {
        if self.is_learning {
            self.is_fixed = inside.0;
        }
    }

    /// Runs at the end of every frame. Returns the time that the step clock will show at this frame.
    pub fn frame(&mut self, fixed: &Time<Fixed>) -> f64 {
        let now = fixed.elapsed_secs_f64() + fixed.overstep().as_secs_f64();
        self.lag.frame(now);
        now
    }
}
