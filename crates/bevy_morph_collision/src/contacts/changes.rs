//! Contacts that started or ended in the last run, or in all runs of a frame.

use bevy::prelude::*;

use super::contact::MorphContact;

/// Pairs that started and contacts that ended, in the order of runs.
///
/// In a fixed schedule there may be any number of runs per frame. Systems in fixed schedules then see the changes of the last
/// run. All other systems see those of all runs of the frame. Each of them sees every change once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes {
    pub(crate) started: Vec<(Entity, Entity)>,
    pub(crate) ended: Vec<MorphContact>,
    /// Where the changes of the last run start.
    pub(super) run: (usize, usize),
    /// Where, in `ended`, the contacts start that both began and ended in the last run.
    pub(super) passed: usize,
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

    /// Says that the plugin runs in a fixed schedule, so there may be several runs in a frame.
    pub(crate) fn set_fixed(&mut self) {
        self.is_fixed = true;
    }

    /// Goes back to an earlier run of the same plugin.
    pub(super) fn restore(&mut self, earlier: Self) {
        *self = Self {
            is_fixed: self.is_fixed,
            // Runs that are simulated again are outside of the frame's loop, and systems of the simulation see each of them.
            has_run: false,
            shown: Shown::Run,
            ..earlier
        };
    }

    /// The fixed schedules begin: systems see the last run, which may have been several frames ago.
    pub(crate) fn show_run(&mut self) {
        self.has_run = false;
        self.shown = Shown::Run;
    }

    /// The fixed schedules end: systems see the changes of the whole frame.
    pub(crate) fn show_frame(&mut self) {
        self.shown = if self.has_run { Shown::Frame } else { Shown::Nothing };
        self.has_run = false;
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
