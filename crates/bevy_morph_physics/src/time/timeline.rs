//! One value over time: who changes it, and what it was at some time.

use super::recorded_frames::{Change, RecordedFrames};
use super::recorded_value::RecordedValue;

/// One value over time.
///
/// A value that changes once per frame is interpolated linearly between frames, and a physics step uses the interpolated value of
/// its own time. A value that changes once per step (because a system in a fixed schedule animates it) is used directly.
pub struct Timeline<T> {
    frames: RecordedFrames<T>,
    /// Whether steps change the value.
    changes_per_step: bool,
    /// The value in the last step.
    seen: Option<T>,
    expected: Teleport,
}

/// For how much longer the next change is a teleport.
#[derive(Default)]
struct Teleport {
    frames: u8,
    steps: u8,
}

impl<T> Default for Timeline<T> {
    fn default() -> Self {
        Self {
            frames: RecordedFrames::default(),
            changes_per_step: true,
            seen: None,
            expected: Teleport::default(),
        }
    }
}

impl<T: RecordedValue> Timeline<T> {
    /// Says that the game teleports the value: its next change is no motion.
    ///
    /// The change may become visible one frame or step later.
    pub fn teleport(&mut self) {
        self.expected = Teleport { frames: 2, steps: 2 };
    }

    /// Says that the value may have changed while time stood still: if the next step finds a change, that is no motion.
    pub fn pause(&mut self) {
        self.expected.steps = self.expected.steps.max(1);
    }

    /// Records what a frame is drawn with. `max_acceleration` separates motion from jumps.
    pub fn record(&mut self, time: f64, value: &T, max_acceleration: f32) {
        let Some(last) = self.frames.last() else {
            self.frames.push(time, value, Change::Motion);
            return;
        };
        if time <= last.time {
            if self.frames.stand_still(time, value) {
                self.pause();
            }
            return;
        }
        let changed = !value.is_same(&last.value);
        let is_teleport = changed && self.expected.frames > 0;
        self.expected.frames = if changed {
            0
        } else {
            self.expected.frames.saturating_sub(1)
        };
        if !changed && self.frames.extend_rest(time, value) {
            return;
        }
        let change = if is_teleport {
            Change::Teleport
        } else if self.frames.jumps(time, value, max_acceleration) {
            Change::Jump
        } else {
            Change::Motion
        };
        self.frames.push(time, value, change);
    }

    /// Forgets frames that steps from this time on do not need.
    pub fn forget_before(&mut self, time: f64) {
        self.frames.forget_before(time);
    }

    /// Compares with what a step finds, to decide whether frames or steps change the value.
    pub fn step(&mut self, live: &T) {
        if let Some(drawn) = self.frames.last() {
            if !live.is_same(&drawn.value) {
                self.changes_per_step = true;
            } else if self.seen.as_ref().is_some_and(|seen| !drawn.value.is_same(seen)) {
                self.changes_per_step = false;
            }
        }
        self.set_seen(live);
    }

    /// Whether a change that the coming step finds is no motion.
    pub fn teleports_in_step(&mut self, changed: bool) -> bool {
        let is_teleport = changed && self.expected.steps > 0;
        self.expected.steps = if changed {
            0
        } else {
            self.expected.steps.saturating_sub(1)
        };
        is_teleport
    }

    fn set_seen(&mut self, live: &T) {
        match &mut self.seen {
            Some(seen) => seen.clone_from(live),
            seen => *seen = Some(live.clone()),
        }
    }

    /// Compares with the last step while time stands still or no steps come: what has changed is no motion.
    pub fn rest(&mut self, live: &T) {
        if self.differs(live) {
            self.pause();
        }
        self.step(live);
    }

    fn differs(&self, live: &T) -> bool {
        self.seen.as_ref().is_some_and(|seen| !seen.is_same(live))
    }

    /// Compares with the value after the steps of a frame: a system may have changed it after the last step.
    pub fn after_steps(&mut self, live: &T) {
        if self.differs(live) {
            self.set_seen(live);
            self.changes_per_step = true;
        }
    }

    /// Whether the value is interpolated between frames.
    pub fn is_interpolated(&self) -> bool {
        !self.changes_per_step && !self.frames.is_empty()
    }

    /// The value at some time; `None` if the live value should be used.
    pub fn at(&self, time: f64) -> Option<T> {
        if self.is_interpolated() {
            self.frames.at(time)
        } else {
            None
        }
    }

    /// Whether the value was teleported between two times.
    pub fn teleports_between(&self, begin: f64, end: f64) -> bool {
        self.frames.teleports().any(|time| begin <= time && time < end)
    }

    /// The last time before another one at which the value was teleported.
    pub fn last_teleport(&self, before: f64) -> Option<f64> {
        self.frames.teleports().filter(|&time| time < before).last()
    }

    /// The times of the frames around a time span, and of one frame before it.
    pub fn frames_around(&self, begin: f64, end: f64) -> impl Iterator<Item = f64> {
        self.frames.around(begin, end)
    }

    /// Declares that only frames change the value.
    pub fn interpolate(&mut self) {
        self.changes_per_step = false;
    }
}

#[cfg(test)]
mod tests {
    use super::super::recorded_frames::MAX_FRAMES;
    use super::*;

    fn weights(weight: f32) -> Vec<f32> {
        vec![weight]
    }

    /// Records weights at times. Frames change them, not steps.
    fn recorded(frames: &[(f64, f32)]) -> Timeline<Vec<f32>> {
        let mut timeline = Timeline::default();
        timeline.interpolate();
        for &(time, weight) in frames {
            timeline.record(time, &weights(weight), 100.0);
        }
        timeline
    }

    #[test]
    fn what_changes_while_time_stands_still_is_there_at_once() {
        for pause in [&[(1.0, 0.7)][..], &[(1.0, 0.3), (1.0, 0.7), (1.0, 0.7)]] {
            let mut timeline = recorded(&[&[(0.0, 0.0), (0.5, 0.0), (1.0, 0.0)][..], pause].concat());
            timeline.interpolate();
            timeline.record(1.5, &weights(0.8), 100.0);
            assert_eq!(timeline.at(1.0), Some(weights(0.0)));
            assert_eq!(timeline.at(1.0_f64.next_up()), Some(weights(0.7)));
            assert_eq!(timeline.at(1.25), Some(weights(0.75)));
            assert!(timeline.teleports_between(0.9, 1.1) && timeline.teleports_between(1.0, 1.1));
            assert!(!timeline.teleports_between(0.9, 1.0) && !timeline.teleports_between(1.1, 2.0));
        }
    }

    #[test]
    fn time_that_is_set_back_begins_a_new_timeline() {
        let mut timeline = recorded(&[(8.0, 0.0), (9.0, 0.5), (2.0, 0.6), (3.0, 0.7)]);
        timeline.interpolate();
        assert_eq!(timeline.at(1.0), Some(weights(0.5)));
        assert_eq!(timeline.at(2.5), Some(weights(0.65)));
        assert!(timeline.teleports_between(1.5, 2.5));
    }

    #[test]
    fn what_the_game_puts_elsewhere_is_never_in_between() {
        let mut timeline = recorded(&[(0.0, 0.0), (1.0, 0.0)]);
        timeline.teleport();
        // A hierarchy may be placed one frame later.
        timeline.record(2.0, &weights(0.0), 100.0);
        timeline.record(3.0, &weights(1.0), 100.0);
        timeline.record(4.0, &weights(2.0), 100.0);
        assert_eq!(timeline.at(2.5), Some(weights(1.0)));
        assert_eq!(timeline.at(3.5), Some(weights(1.5)));
        assert!(timeline.teleports_between(2.0, 2.5) && !timeline.teleports_between(2.5, 4.0));
        assert_eq!(timeline.last_teleport(3.0), Some(2.0));
    }

    #[test]
    fn what_was_announced_long_ago_is_motion_again() {
        let mut timeline = recorded(&[(0.0, 0.0), (1.0, 0.0)]);
        timeline.teleport();
        for time in [2.0, 3.0, 4.0] {
            timeline.record(time, &weights(0.0), 100.0);
        }
        timeline.record(5.0, &weights(1.0), 100.0);
        assert_eq!(timeline.at(4.5), Some(weights(0.5)));
    }

    #[test]
    fn very_many_frames_between_two_steps_stay_within_bounds() {
        let mut timeline = recorded(&[]);
        for frame in 0..1000_u16 {
            let jump = if frame < 700 { 0.0 } else { 1.0 };
            if frame == 700 {
                timeline.teleport();
            }
            timeline.record(f64::from(frame), &weights(0.001 * f32::from(frame) + jump), 100.0);
            assert!(timeline.frames.len() <= MAX_FRAMES);
        }
        for (time, weight) in [(0.0, 0.0), (350.0, 0.35), (699.0, 0.699), (700.0, 1.7), (999.0, 1.999)] {
            let found = timeline.at(time).unwrap()[0];
            assert!((found - weight).abs() < 1e-4, "{found}, not {weight} at {time}");
        }
        timeline.forget_before(998.0);
        assert!(timeline.frames.len() < 5, "{}", timeline.frames.len());
    }
}
