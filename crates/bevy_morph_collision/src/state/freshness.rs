//! What has changed since the last run: for one collider ([`Freshness`]) and for all of them ([`Runs`]).
//!
//! | what | set by | read by | cleared by |
//! |---|---|---|---|
//! | the bounds are of an earlier pose | `setup`, `posing`: [`Freshness::pose_changed`]; `state`: [`Freshness::look_again`] | `broad_phase` | `broad_phase`: [`Freshness::bounds_computed`] |
//! | the answers are of an earlier state | `setup`, `posing`: [`Freshness::pose_changed`]; `broad_phase`: [`Freshness::placement_changed`], [`Freshness::show_current`] | `broad_phase`, `narrow_phase` | `narrow_phase`: [`Freshness::compared`]; `broad_phase`: [`Freshness::hold_back`] |
//! | collisions see an earlier state (tolerance) | `broad_phase`: [`Freshness::hold_back`] | `broad_phase` | `broad_phase`: [`Freshness::show_current`], [`Freshness::stop_holding`] |
//! | it was read in the last run | `broad_phase`: [`Freshness::see`] | `setup`, `posing`, `self_collisions`, `spatial` | a run in which its entity is disabled |
//! | any answer is of an earlier state | `broad_phase`: [`Runs::placed`] | `broad_phase`, `narrow_phase` | the next run |
//! | pairs were compared in this run | `narrow_phase`: [`Runs::compare`] | `events` | the next run |
//! | runs were left out while paused | `events`: [`Runs::interrupt`] | `broad_phase` | `broad_phase`: [`Runs::take_interruption`] |

use bevy::prelude::*;

/// What has changed about one collider.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Freshness {
    /// Whether the pose was replaced, or got other weights or joints, since its bounds were last computed.
    bounds_are_old: bool,
    /// Whether anything that affects an answer differs from the last run. With a tolerance: whether the state that collisions see
    /// has changed.
    answers_are_old: bool,
    /// Whether the collider has changed since the earlier state was taken that collisions see.
    is_held_back: bool,
    /// [`Runs::number`] when the collider was last read. Disabled entities are not read.
    seen: u32,
}

impl Freshness {
    /// The pose was replaced, or has other weights or joints.
    pub(crate) fn pose_changed(&mut self) {
        self.bounds_are_old = true;
        self.answers_are_old = true;
    }

    /// The bounds of the current pose are known.
    pub(crate) fn bounds_computed(&mut self) {
        self.bounds_are_old = false;
    }

    pub(crate) fn bounds_are_old(&self) -> bool {
        self.bounds_are_old
    }

    /// Places the collider anew in the next run, from what it depends on and not from what has changed.
    pub(crate) fn look_again(&mut self) {
        self.bounds_are_old = true;
    }

    /// Something besides the pose changed that affects an answer.
    pub(crate) fn placement_changed(&mut self) {
        self.answers_are_old = true;
    }

    pub(crate) fn answers_are_old(&self) -> bool {
        self.answers_are_old
    }

    /// The collider was compared. One that took no part counts as changed when it comes back.
    pub(crate) fn compared(&mut self, took_part: bool) {
        self.answers_are_old = !took_part;
    }

    /// Collisions go on to see the earlier state.
    pub(crate) fn hold_back(&mut self) {
        self.is_held_back |= self.answers_are_old;
        self.answers_are_old = false;
    }

    /// Collisions see the current state from now on.
    pub(crate) fn show_current(&mut self) {
        self.answers_are_old = true;
        self.is_held_back = false;
    }

    /// There is no earlier state any more. The last answers may be for one.
    pub(crate) fn stop_holding(&mut self) {
        self.answers_are_old |= self.is_held_back;
        self.is_held_back = false;
    }

    /// Whether collisions see a state from which the current one differs.
    pub(crate) fn is_held_back(&self) -> bool {
        self.is_held_back
    }

    /// The collider is read in this run. Returns whether it was not in the run before.
    pub(crate) fn see(&mut self, runs: &Runs) -> bool {
        let was_absent = self.seen != runs.number && self.seen.wrapping_add(1) != runs.number;
        self.seen = runs.number;
        was_absent
    }

    /// Whether the collider was read in the last run.
    pub(crate) fn is_seen(&self, runs: &Runs) -> bool {
        self.seen == runs.number
    }
}

/// The runs so far, and what has changed in the last one.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(crate) struct Runs {
    /// Increases in every run that reads other colliders than the one before.
    number: u32,
    /// Increases in every run in which a collider moved, was added or was removed.
    version: u64,
    any_changed: bool,
    compared: bool,
    is_interrupted: bool,
}

impl Runs {
    /// Goes back to earlier runs. Whoever has kept something for a version has to look again.
    pub(crate) fn restore(&mut self, earlier: Self) {
        let version = self.version + 1;
        *self = Self { version, ..earlier };
    }

    /// Begins to place colliders. If they are the same as in the last run, those that do not change need not be read.
    pub(crate) fn begin(&mut self, are_same: bool) {
        if !are_same {
            self.number = self.number.wrapping_add(1);
        }
    }

    /// All colliders are placed. Says whether any answer is for an earlier state, and whether any collider moved, was added or was
    /// removed.
    pub(crate) fn placed(&mut self, any_changed: bool, any_moved: bool) {
        self.any_changed = any_changed;
        self.version += u64::from(any_changed || any_moved);
    }

    /// Whether any collider changed, was added or was removed since the previous run.
    pub(crate) fn any_changed(&self) -> bool {
        self.any_changed
    }

    /// A number that is different after each run in which a collider moved, was added or was removed.
    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    /// Returns whether to compare pairs in this run: if anything changed, or if all pairs are to be compared again.
    pub(crate) fn compare(&mut self, all_again: bool) -> bool {
        self.compared = self.any_changed || all_again;
        self.compared
    }

    /// Whether pairs were compared in the last run.
    pub(crate) fn compared(&self) -> bool {
        self.compared
    }

    /// Runs are left out because collisions are paused. Motion in the meantime does not count.
    pub(crate) fn interrupt(&mut self) {
        self.is_interrupted = true;
    }

    /// Whether runs were left out before this one.
    pub(crate) fn take_interruption(&mut self) -> bool {
        std::mem::take(&mut self.is_interrupted)
    }
}
