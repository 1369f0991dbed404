//! Contacts that started or ended in the last run, or in all runs of a frame.

use bevy::app::{FixedFirst, FixedLast, FixedPostUpdate, FixedPreUpdate, FixedUpdate};
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;

use crate::broad_phase::Candidates;
use crate::contacts::{MorphCollisions, MorphContact};

/// Pairs that started and contacts that ended, in the order of runs.
///
/// In a fixed schedule there may be any number of runs per frame. Systems in fixed schedules then see the changes of the last
/// run. All other systems see those of all runs of the frame. Each of them sees every change once.
#[derive(Debug, Default)]
pub(crate) struct Changes {
    pub(crate) started: Vec<(Entity, Entity)>,
    pub(crate) ended: Vec<MorphContact>,
    /// Where the changes of the last run start.
    run: (usize, usize),
    /// Where, in `ended`, the contacts start that both began and ended in the last run.
    passed: usize,
    /// Whether the plugin runs in a fixed schedule.
    is_fixed: bool,
    /// Whether there was a run since the fixed schedules were entered.
    has_run: bool,
    shown: Shown,
}

#[derive(Debug, Default, Clone, Copy, PartialEq)]
enum Shown {
    #[default]
    Run,
    Frame,
    Nothing,
}

impl Changes {
    /// Begins a run, in which nothing has started or ended yet.
    pub(crate) fn begin_run(&mut self) {
        if !(self.is_fixed && self.has_run) {
            self.started.clear();
            self.ended.clear();
        }
        self.has_run = true;
        self.run = (self.started.len(), self.ended.len());
        self.passed = self.ended.len();
        if self.shown == Shown::Nothing {
            self.shown = Shown::Run;
        }
    }

    /// Sorts the changes of this run by their colliders. Adds contacts that began and ended within the run.
    pub(crate) fn end_run(&mut self, mut passed: Vec<MorphContact>) {
        self.ended[self.run.1..].sort_unstable_by_key(MorphContact::pair);
        passed.sort_unstable_by_key(MorphContact::pair);
        self.started.extend(passed.iter().map(MorphContact::pair));
        self.started[self.run.0..].sort_unstable();
        self.passed = self.ended.len();
        self.ended.append(&mut passed);
    }

    /// The pairs that started in the last run.
    pub(crate) fn started_in_run(&self) -> &[(Entity, Entity)] {
        &self.started[self.run.0..]
    }

    /// The contacts of earlier runs that ended in the last run.
    pub(crate) fn ended_in_run(&self) -> &[MorphContact] {
        &self.ended[self.run.1..self.passed]
    }

    /// The contacts that began and ended in the last run.
    pub(crate) fn passed_in_run(&self) -> &[MorphContact] {
        &self.ended[self.passed..]
    }

    /// The pairs that started, as the current caller should see them.
    pub(crate) fn started(&self) -> &[(Entity, Entity)] {
        match self.shown {
            Shown::Run => self.started_in_run(),
            Shown::Frame => &self.started,
            Shown::Nothing => &[],
        }
    }

    /// The contacts that ended, as the current caller should see them.
    pub(crate) fn ended(&self) -> &[MorphContact] {
        match self.shown {
            Shown::Run => &self.ended[self.run.1..],
            Shown::Frame => &self.ended,
            Shown::Nothing => &[],
        }
    }
}

/// Whether a schedule runs once per fixed time step.
pub(crate) fn is_fixed(schedule: InternedScheduleLabel) -> bool {
    let fixed = [
        FixedFirst.intern(),
        FixedPreUpdate.intern(),
        FixedUpdate.intern(),
        FixedPostUpdate.intern(),
        FixedLast.intern(),
    ];
    fixed.contains(&schedule)
}

/// If the schedule is a fixed one, shows the changes to the systems around it, too.
pub(crate) fn follow_frames(app: &mut App, schedule: InternedScheduleLabel) {
    if !is_fixed(schedule) {
        return;
    }
    app.world_mut().resource_mut::<MorphCollisions>().changes.is_fixed = true;
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
    let changes = &mut collisions.bypass_change_detection().changes;
    changes.has_run = false;
    changes.shown = Shown::Run;
}

/// Systems in the rest of the frame see the changes of the whole frame.
fn show_frame(mut collisions: ResMut<MorphCollisions>) {
    let changes = &mut collisions.bypass_change_detection().changes;
    changes.shown = if changes.has_run { Shown::Frame } else { Shown::Nothing };
    changes.has_run = false;
}

/// While the plugin is paused, nothing starts or ends, and motion does not count.
pub(crate) fn begin_empty_run(mut collisions: ResMut<MorphCollisions>, mut candidates: ResMut<Candidates>) {
    collisions.bypass_change_detection().changes.begin_run();
    candidates.bypass_change_detection().swept.is_interrupted = true;
}
