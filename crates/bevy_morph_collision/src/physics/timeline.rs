//! What a surface was drawn with at the last few frames, and between them.

use std::collections::VecDeque;

use bevy::math::{Affine3A, DVec3, Vec3};

use super::motion::continuous;

/// A value that a surface is made of: weights, joints, its place.
pub(crate) trait Drawn: Clone {
    /// Whether they are the same, but for rounding.
    fn is(&self, other: &Self) -> bool;

    /// The value on the straight way to another one.
    fn towards(&self, other: &Self, share: f32) -> Self;

    /// Points that are far away from where they were when the surface is somewhere else altogether; none if it never is.
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

/// Joints as a collider sees them, and a point of the mesh, the middle of its bounds.
#[derive(Clone)]
pub(crate) struct DrawnJoints {
    pub(crate) matrices: Vec<Affine3A>,
    pub(crate) middle: Vec3,
}

impl Drawn for DrawnJoints {
    fn is(&self, other: &Self) -> bool {
        let (a, b) = (self.points(), other.points());
        let size = b.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let close = |a: &[f32; 12], b: &[f32; 12]| {
            a[..9]
                .iter()
                .zip(b)
                .all(|(a, b)| (a - b).abs() <= 1e-6 * (1.0 + b.abs()))
        };
        // Removing the collider's place leaves rounding behind.
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
/// What changes once a frame is drawn on the straight ways between frames: a step of physics sees it there, whenever it is. What changes once a step
/// (because a system in a fixed schedule animates it) is seen as it is.
pub(crate) struct Timeline<T> {
    frames: VecDeque<Frame<T>>,
    /// Whether steps change it.
    follows_steps: bool,
    /// As the last step saw it.
    seen: Option<T>,
}

struct Frame<T> {
    time: f64,
    value: T,
    /// Whether it came here all at once.
    jumped: bool,
}

/// Frames are kept for so many seconds: longer than two steps and what physics is behind, where there are more frames than steps.
const MAX_AGE: f64 = 0.1;
/// So many are kept, however old: those around a step, and two before.
const MIN_FRAMES: usize = 6;
/// And no more than these, however short they are.
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
    /// What a frame is drawn with. `max_acceleration` tells a motion from a jump.
    pub(crate) fn record(&mut self, time: f64, value: &T, max_acceleration: f32) {
        while self.frames.back().is_some_and(|last| last.time >= time) {
            // Time stood still, or was set back.
            self.frames.pop_back();
        }
        let mut last = self.frames.iter_mut().rev();
        if let (Some(last), Some(before)) = (last.next(), last.next())
            && value.is(&last.value)
            && last.value.is(&before.value)
        {
            // It rests.
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

    /// What a step finds: decides who changes the value.
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

    /// What there is after the steps of a frame: a system may have changed it after the last of them.
    pub(crate) fn after_steps(&mut self, live: &T) {
        if let Some(seen) = &mut self.seen
            && !live.is(seen)
        {
            *seen = live.clone();
            self.follows_steps = true;
        }
    }

    /// Whether the value is drawn on ways between frames.
    pub(crate) fn follows_frames(&self) -> bool {
        !self.follows_steps && !self.frames.is_empty()
    }

    /// The value at some time; `None` if it is to be taken as it is.
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

    /// The times of the frames around a span of time, and of one frame before it.
    pub(crate) fn frames_around(&self, begin: f64, end: f64) -> impl Iterator<Item = f64> {
        let first = self
            .frames
            .partition_point(|frame| frame.time <= begin)
            .saturating_sub(2);
        let last = self.frames.partition_point(|frame| frame.time < end);
        let frames = self.frames.iter().take(last + 1).skip(first);
        frames.map(|frame| frame.time)
    }

    /// Nothing but frames changes the value.
    pub(crate) fn follow_frames(&mut self) {
        self.follows_steps = false;
    }
}
