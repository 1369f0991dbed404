//! What a surface was drawn with in the last few frames, and between them.

use std::collections::VecDeque;

use bevy::math::{Affine3A, DVec3, Vec3};

use super::motion::{continuous, largest};

/// A value that determines a surface: weights, joints or place.
pub(crate) trait Drawn: Clone {
    /// Whether two values are the same up to rounding.
    fn is(&self, other: &Self) -> bool;

    /// Interpolates linearly to another value.
    fn towards(&self, other: &Self, share: f32) -> Self;

    /// Points that move far if the surface teleports. Empty if the value cannot teleport.
    fn points(&self) -> Vec<DVec3>;
}

impl Drawn for Vec<f32> {
    fn is(&self, other: &Self) -> bool {
        self == other
    }

    fn towards(&self, other: &Self, share: f32) -> Self {
        let between = |(a, b): (&f32, &f32)| a + (b - a) * share;
        self.iter().zip(other).map(between).collect()
    }

    fn points(&self) -> Vec<DVec3> {
        Vec::new()
    }
}

impl Drawn for Affine3A {
    fn is(&self, other: &Self) -> bool {
        self == other
    }

    fn towards(&self, other: &Self, share: f32) -> Self {
        let [a, b] = [self, other].map(Affine3A::to_cols_array);
        Self::from_cols_array(&std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share))
    }

    fn points(&self) -> Vec<DVec3> {
        vec![Vec3::from(self.translation).as_dvec3()]
    }
}

/// Joints in the collider's space, and a point of the mesh, the middle of its bounds.
#[derive(Clone)]
pub(crate) struct DrawnJoints {
    pub(crate) matrices: Vec<Affine3A>,
    pub(crate) middle: Vec3,
}

impl Drawn for DrawnJoints {
    fn is(&self, other: &Self) -> bool {
        let (a, b) = (self.points(), other.points());
        let size = largest(b.iter().map(|p| p.abs().max_element()));
        let close = |a: &[f32; 12], b: &[f32; 12]| {
            let (a, b) = (&a[..9], &b[..9]);
            // Its scale may be that of another unit of length.
            let scale = largest(b.iter().map(|b| b.abs()));
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * scale)
        };
        // Removing the collider's place leaves rounding errors.
        a.len() == b.len()
            && a.iter().zip(&b).all(|(a, b)| a.distance(*b) <= 1e-6 * size)
            && self
                .matrices
                .iter()
                .zip(&other.matrices)
                .all(|(a, b)| close(&a.to_cols_array(), &b.to_cols_array()))
    }

    fn towards(&self, other: &Self, share: f32) -> Self {
        let matrices = self.matrices.iter().zip(&other.matrices);
        Self {
            matrices: matrices.map(|(a, b)| a.towards(b, share)).collect(),
            middle: self.middle,
        }
    }

    fn points(&self) -> Vec<DVec3> {
        let middle = |joint: &Affine3A| joint.transform_point3(self.middle).as_dvec3();
        self.matrices.iter().map(middle).collect()
    }
}

/// One value over time.
///
/// A value that changes once per frame is interpolated linearly between frames, and a physics step uses the interpolated value of
/// its own time. A value that changes once per step (because a system in a fixed schedule animates it) is used directly.
pub(crate) struct Timeline<T> {
    frames: VecDeque<Frame<T>>,
    /// Whether steps change the value.
    follows_steps: bool,
    /// The value in the last step.
    seen: Option<T>,
    /// For how many frames, and for how many steps, the next change is no motion.
    put: (u8, u8),
}

struct Frame<T> {
    time: f64,
    value: T,
    change: Change,
}

/// How a value came from that of the frame before.
#[derive(Clone, Copy, PartialEq)]
enum Change {
    Motion,
    /// Too fast for a motion. The value jumped right after the frame before.
    Jump,
    /// It was put there: the game said so, or time stood still. It was put right after the frame before, whose time is the same if
    /// time stood still.
    Put,
}

/// How long frames are kept that no step needs any more, in seconds. Physics may fall back that far.
const SPARE: f64 = 0.1;
/// The maximum number of frames that are kept. If there are more between two steps, some are left out.
const MAX_FRAMES: usize = 64;

impl<T> Default for Timeline<T> {
    fn default() -> Self {
        Self {
            frames: VecDeque::new(),
            follows_steps: true,
            seen: None,
            put: (0, 0),
        }
    }
}

impl<T: Drawn> Timeline<T> {
    /// Says that the game puts the value elsewhere: its next change is no motion.
    ///
    /// The change may become visible one frame or step later.
    pub(crate) fn put(&mut self) {
        self.put = (2, 2);
    }

    /// Says that the value may have changed while time stood still: if the next step finds a change, that is no motion.
    pub(crate) fn pause(&mut self) {
        self.put.1 = self.put.1.max(1);
    }

    /// Records what a frame is drawn with. `max_acceleration` separates motion from jumps.
    pub(crate) fn record(&mut self, time: f64, value: &T, max_acceleration: f32) {
        let Some(last) = self.frames.back() else {
            self.push(time, value, Change::Motion);
            return;
        };
        if time <= last.time {
            self.stand_still(time, value);
            return;
        }
        let changed = !value.is(&last.value);
        let is_put = changed && self.put.0 > 0;
        self.put.0 = if changed { 0 } else { self.put.0.saturating_sub(1) };
        let mut last = self.frames.iter_mut().rev();
        if let (Some(last), Some(before)) = (last.next(), last.next())
            && !changed
            && last.value.is(&before.value)
        {
            // The value is at rest.
            last.time = time;
            return;
        }
        let change = if is_put {
            Change::Put
        } else if self.jumps(time, value, max_acceleration) {
            Change::Jump
        } else {
            Change::Motion
        };
        self.push(time, value, change);
    }

    /// Records a value while time stands still, or after it was set back.
    fn stand_still(&mut self, time: f64, value: &T) {
        let Some(mut last) = self.frames.pop_back() else {
            return;
        };
        if time < last.time {
            self.frames.clear();
            last.time = time;
        }
        let changed = !value.is(&last.value);
        // Of several values at one time, the first and the last count.
        if !changed || self.frames.back().is_none_or(|before| before.time < time) {
            self.frames.push_back(last);
        }
        if changed {
            self.push(time, value, Change::Put);
            self.pause();
        }
    }

    fn push(&mut self, time: f64, value: &T, change: Change) {
        if self.frames.len() >= MAX_FRAMES {
            self.thin_out();
        }
        let value = value.clone();
        self.frames.push_back(Frame { time, value, change });
    }

    /// Leaves out every other frame, except around jumps.
    fn thin_out(&mut self) {
        let changes: Vec<Change> = self.frames.iter().skip(1).map(|frame| frame.change).collect();
        let mut place = 0;
        self.frames.retain(|frame| {
            let jumps_next = changes.get(place).is_none_or(|&change| change != Change::Motion);
            place += 1;
            place % 2 == 1 || frame.change != Change::Motion || jumps_next
        });
        while self.frames.len() >= MAX_FRAMES {
            self.frames.pop_front();
        }
    }

    /// Forgets frames that steps from this time on do not need.
    pub(crate) fn forget_before(&mut self, time: f64) {
        // Two frames before it say how fast the value moves then.
        while self.frames.get(2).is_some_and(|frame| frame.time <= time - SPARE) {
            self.frames.pop_front();
        }
    }

    fn jumps(&self, time: f64, value: &T, max_acceleration: f32) -> bool {
        let mut last = self.frames.iter().rev();
        let Some(before) = last.next() else { return false };
        let velocities = |from: &Frame<T>, to: &T, at: f64| {
            let (from_points, to_points) = (from.value.points(), to.points());
            let ways = from_points.iter().zip(to_points);
            ways.map(|(from_point, to_point)| (to_point - from_point) / (at - from.time))
                .collect::<Vec<_>>()
        };
        let now = velocities(before, value, time);
        let earlier = last
            .next()
            .map(|earlier| velocities(earlier, &before.value, before.time));
        let limit = f64::from(max_acceleration) * (time - before.time);
        !continuous(&now, earlier.as_deref(), limit)
    }

    /// Compares with what a step finds, to decide whether frames or steps change the value.
    pub(crate) fn step(&mut self, live: &T) {
        if let Some(drawn) = self.frames.back() {
            if !live.is(&drawn.value) {
                self.follows_steps = true;
            } else if self.seen.as_ref().is_some_and(|seen| !drawn.value.is(seen)) {
                self.follows_steps = false;
            }
        }
        self.see(live);
    }

    /// Whether a change that the coming step finds is no motion.
    pub(crate) fn is_put_in_step(&mut self, changed: bool) -> bool {
        let is_put = changed && self.put.1 > 0;
        self.put.1 = if changed { 0 } else { self.put.1.saturating_sub(1) };
        is_put
    }

    fn see(&mut self, live: &T) {
        match &mut self.seen {
            Some(seen) => seen.clone_from(live),
            seen => *seen = Some(live.clone()),
        }
    }

    /// The same while time stands still or no steps come: what has changed is no motion.
    pub(crate) fn rest(&mut self, live: &T) {
        if self.differs(live) {
            self.pause();
        }
        self.step(live);
    }

    fn differs(&self, live: &T) -> bool {
        self.seen.as_ref().is_some_and(|seen| !seen.is(live))
    }

    /// Compares with the value after the steps of a frame: a system may have changed it after the last step.
    pub(crate) fn after_steps(&mut self, live: &T) {
        if self.differs(live) {
            self.see(live);
            self.follows_steps = true;
        }
    }

    /// Whether the value is interpolated between frames.
    pub(crate) fn follows_frames(&self) -> bool {
        !self.follows_steps && !self.frames.is_empty()
    }

    /// The value at some time; `None` if the live value should be used.
    pub(crate) fn at(&self, time: f64) -> Option<T> {
        if !self.follows_frames() {
            return None;
        }
        let next = self.frames.partition_point(|frame| frame.time < time);
        let before = next.checked_sub(1).and_then(|place| self.frames.get(place));
        Some(match (before, self.frames.get(next)) {
            (Some(before), Some(next)) if next.change == Change::Motion && next.time > time => {
                let share = (time - before.time) / (next.time - before.time);
                before.value.towards(&next.value, share as f32)
            }
            (_, Some(frame)) | (Some(frame), None) => frame.value.clone(),
            (None, None) => return None,
        })
    }

    /// Whether the value was put somewhere between two times.
    pub(crate) fn is_put_between(&self, begin: f64, end: f64) -> bool {
        self.puts().any(|time| begin <= time && time < end)
    }

    /// The last time before another one at which the value was put somewhere.
    pub(crate) fn last_put(&self, before: f64) -> Option<f64> {
        self.puts().filter(|&time| time < before).last()
    }

    fn puts(&self) -> impl Iterator<Item = f64> {
        let pairs = self.frames.iter().zip(self.frames.iter().skip(1));
        pairs
            .filter(|(_, frame)| frame.change == Change::Put)
            .map(|(before, _)| before.time)
    }

    /// The times of the frames around a time span, and of one frame before it.
    pub(crate) fn frames_around(&self, begin: f64, end: f64) -> impl Iterator<Item = f64> {
        let first = self
            .frames
            .partition_point(|frame| frame.time <= begin)
            .saturating_sub(2);
        let last = self.frames.partition_point(|frame| frame.time < end);
        let frames = self.frames.iter().take(last + 1).skip(first);
        frames.map(|frame| frame.time)
    }

    /// Declares that only frames change the value.
    pub(crate) fn follow_frames(&mut self) {
        self.follows_steps = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(weight: f32) -> Vec<f32> {
        vec![weight]
    }

    /// Records weights at times. Frames change them, not steps.
    fn recorded(frames: &[(f64, f32)]) -> Timeline<Vec<f32>> {
        let mut timeline = Timeline::default();
        timeline.follow_frames();
        for &(time, weight) in frames {
            timeline.record(time, &weights(weight), 100.0);
        }
        timeline
    }

    #[test]
    fn what_changes_while_time_stands_still_is_there_at_once() {
        for pause in [&[(1.0, 0.7)][..], &[(1.0, 0.3), (1.0, 0.7), (1.0, 0.7)]] {
            let mut timeline = recorded(&[&[(0.0, 0.0), (0.5, 0.0), (1.0, 0.0)][..], pause].concat());
            timeline.follow_frames();
            timeline.record(1.5, &weights(0.8), 100.0);
            assert_eq!(timeline.at(1.0), Some(weights(0.0)));
            assert_eq!(timeline.at(1.0_f64.next_up()), Some(weights(0.7)));
            assert_eq!(timeline.at(1.25), Some(weights(0.75)));
            assert!(timeline.is_put_between(0.9, 1.1) && timeline.is_put_between(1.0, 1.1));
            assert!(!timeline.is_put_between(0.9, 1.0) && !timeline.is_put_between(1.1, 2.0));
        }
    }

    #[test]
    fn time_that_is_set_back_begins_a_new_timeline() {
        let mut timeline = recorded(&[(8.0, 0.0), (9.0, 0.5), (2.0, 0.6), (3.0, 0.7)]);
        timeline.follow_frames();
        assert_eq!(timeline.at(1.0), Some(weights(0.5)));
        assert_eq!(timeline.at(2.5), Some(weights(0.65)));
        assert!(timeline.is_put_between(1.5, 2.5));
    }

    #[test]
    fn what_the_game_puts_elsewhere_is_never_in_between() {
        let mut timeline = recorded(&[(0.0, 0.0), (1.0, 0.0)]);
        timeline.put();
        // A hierarchy may be placed one frame later.
        timeline.record(2.0, &weights(0.0), 100.0);
        timeline.record(3.0, &weights(1.0), 100.0);
        timeline.record(4.0, &weights(2.0), 100.0);
        assert_eq!(timeline.at(2.5), Some(weights(1.0)));
        assert_eq!(timeline.at(3.5), Some(weights(1.5)));
        assert!(timeline.is_put_between(2.0, 2.5) && !timeline.is_put_between(2.5, 4.0));
        assert_eq!(timeline.last_put(3.0), Some(2.0));
    }

    #[test]
    fn what_was_announced_long_ago_is_motion_again() {
        let mut timeline = recorded(&[(0.0, 0.0), (1.0, 0.0)]);
        timeline.put();
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
                timeline.put();
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
