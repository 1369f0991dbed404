//! The values of a few frames, and between them.

use std::collections::VecDeque;

use bevy::math::DVec3;

use super::recorded_value::RecordedValue;
use crate::math::are_continuous;

/// The values with which the last few frames were drawn.
pub(super) struct RecordedFrames<T>(VecDeque<Frame<T>>);

/// The value with which a frame was drawn.
pub(super) struct Frame<T> {
    pub(super) time: f64,
    pub(super) value: T,
    change: Change,
}

impl<T: RecordedValue> Frame<T> {
    /// How fast points move from here to where a value has them at some time.
    fn velocities(&self, to: &T, at: f64) -> impl Iterator<Item = DVec3> + Clone {
        let time = at - self.time;
        let ways = self.value.points().zip(to.points());
        ways.map(move |(from, to)| (to - from) / time)
    }
}

/// How a value came from that of the frame before.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Change {
    Motion,
    /// Too fast for a motion. The value jumped right after the frame before.
    Jump,
    /// It was teleported: the game said so, or time stood still. That was right after the frame before, whose time is the same if
    /// time stood still.
    Teleport,
}

/// How long frames are kept that no step needs any more, in seconds. Physics may fall back that far.
const KEPT_TIME: f64 = 0.1;
/// The maximum number of frames that are kept. If there are more between two steps, some are left out.
pub(super) const MAX_FRAMES: usize = 64;

impl<T> Default for RecordedFrames<T> {
    fn default() -> Self {
        Self(VecDeque::new())
    }
}

impl<T: RecordedValue> RecordedFrames<T> {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn last(&self) -> Option<&Frame<T>> {
        self.0.back()
    }

    /// Records a value at rest: nothing changed in the last two frames. Returns whether that is so.
    pub(super) fn extend_rest(&mut self, time: f64, value: &T) -> bool {
        let mut last = self.0.iter_mut().rev();
        let (Some(last), Some(before)) = (last.next(), last.next()) else {
            return false;
        };
        let rests = value.is_same(&last.value) && last.value.is_same(&before.value);
        if rests {
            last.time = time;
        }
        rests
    }

    /// Records a value while time stands still, or after it was set back. Returns whether it has changed.
    pub(super) fn stand_still(&mut self, time: f64, value: &T) -> bool {
        let Some(mut last) = self.0.pop_back() else {
            return false;
        };
        if time < last.time {
            self.0.clear();
            last.time = time;
        }
        let changed = !value.is_same(&last.value);
        // Of several values at one time, the first and the last count.
        if !changed || self.0.back().is_none_or(|before| before.time < time) {
            self.0.push_back(last);
        }
        if changed {
            self.push(time, value, Change::Teleport);
        }
        changed
    }

    pub(super) fn push(&mut self, time: f64, value: &T, change: Change) {
        if self.0.len() >= MAX_FRAMES {
            self.thin_out();
        }
        let value = value.clone();
        self.0.push_back(Frame { time, value, change });
    }

    /// Leaves out every other frame, except around jumps.
    fn thin_out(&mut self) {
        let changes: Vec<Change> = self.0.iter().skip(1).map(|frame| frame.change).collect();
        let mut index = 0;
        self.0.retain(|frame| {
            let jumps_next = changes.get(index).is_none_or(|&change| change != Change::Motion);
            index += 1;
            index % 2 == 1 || frame.change != Change::Motion || jumps_next
        });
        while self.0.len() >= MAX_FRAMES {
            self.0.pop_front();
        }
    }

    /// Forgets frames that steps from this time on do not need.
    pub(super) fn forget_before(&mut self, time: f64) {
        // Two frames before it say how fast the value moves then.
        while self.0.get(2).is_some_and(|frame| frame.time <= time - KEPT_TIME) {
            self.0.pop_front();
        }
    }

    /// Whether a new value would be a jump and not a motion.
    pub(super) fn jumps(&self, time: f64, value: &T, max_acceleration: f32) -> bool {
        let mut last = self.0.iter().rev();
        let Some(before) = last.next() else { return false };
        let limit = f64::from(max_acceleration) * (time - before.time);
        let earlier = last
            .next()
            .map(|earlier| earlier.velocities(&before.value, before.time));
        !are_continuous(before.velocities(value, time), earlier, limit)
    }

    /// The value at some time.
    pub(super) fn at(&self, time: f64) -> Option<T> {
        let next = self.0.partition_point(|frame| frame.time < time);
        let before = next.checked_sub(1).and_then(|index| self.0.get(index));
        Some(match (before, self.0.get(next)) {
            (Some(before), Some(next)) if next.change == Change::Motion && next.time > time => {
                let share = (time - before.time) / (next.time - before.time);
                before.value.interpolated(&next.value, share as f32)
            }
            (_, Some(frame)) | (Some(frame), None) => frame.value.clone(),
            (None, None) => return None,
        })
    }

    /// The times at which the value was teleported.
    pub(super) fn teleports(&self) -> impl Iterator<Item = f64> {
        let pairs = self.0.iter().zip(self.0.iter().skip(1));
        pairs
            .filter(|(_, frame)| frame.change == Change::Teleport)
            .map(|(before, _)| before.time)
    }

    /// The times of the frames around a time span, and of one frame before it.
    pub(super) fn around(&self, begin: f64, end: f64) -> impl Iterator<Item = f64> {
        let first = self.0.partition_point(|frame| frame.time <= begin).saturating_sub(2);
        let last = self.0.partition_point(|frame| frame.time < end);
        let frames = self.0.iter().take(last + 1).skip(first);
        frames.map(|frame| frame.time)
    }

    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}
