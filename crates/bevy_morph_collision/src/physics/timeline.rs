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
            a[..9]
                .iter()
                .zip(b)
                .all(|(a, b)| (a - b).abs() <= 1e-6 * (1.0 + b.abs()))
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
}

struct Frame<T> {
    time: f64,
    value: T,
    /// Whether the value teleported in this frame.
    jumped: bool,
}

/// How long frames are kept, in seconds: longer than two steps plus the lag of physics, if there are more frames than steps.
const MAX_AGE: f64 = 0.1;
/// The number of frames that are kept however old they are: those around a step, and two before.
const MIN_FRAMES: usize = 6;
/// The maximum number of frames that are kept, however short they are.
const MAX_FRAMES: usize = 64;

impl<T> Default for Timeline<T> {
    fn default() -> Self {
        Self {
            frames: VecDeque::new(),
            follows_steps: true,
            seen: None,
        }
    }
}

impl<T: Drawn> Timeline<T> {
    /// Records what a frame is drawn with. `max_acceleration` separates motion from jumps.
    pub(crate) fn record(&mut self, time: f64, value: &T, max_acceleration: f32) {
        while self.frames.back().is_some_and(|last| last.time >= time) {
            // Time stood still or was set back.
            self.frames.pop_back();
        }
        let mut last = self.frames.iter_mut().rev();
        if let (Some(last), Some(before)) = (last.next(), last.next())
            && value.is(&last.value)
            && last.value.is(&before.value)
        {
            // The value is at rest.
            last.time = time;
            return;
        }
        let is_old = |frame: &Frame<T>| frame.time < time - MAX_AGE;
        while self.frames.len() == MAX_FRAMES
            || self.frames.len() > MIN_FRAMES && self.frames.front().is_some_and(is_old)
        {
            self.frames.pop_front();
        }
        let jumped = self.jumps(time, value, max_acceleration);
        let value = value.clone();
        self.frames.push_back(Frame { time, value, jumped });
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
        self.seen = Some(live.clone());
    }

    /// Compares with the value after the steps of a frame: a system may have changed it after the last step.
    pub(crate) fn after_steps(&mut self, live: &T) {
        if let Some(seen) = &mut self.seen
            && !live.is(seen)
        {
            *seen = live.clone();
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
            (Some(before), Some(next)) if !next.jumped && next.time > time => {
                let share = (time - before.time) / (next.time - before.time);
                before.value.towards(&next.value, share as f32)
            }
            (_, Some(frame)) | (Some(frame), None) => frame.value.clone(),
            (None, None) => return None,
        })
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
