//! The moments of a clip that commands look at.

use morph_collision_models::clip::looped;

/// The moments of a clip: a given number for each second, and its very end, because a clip may end in a pose that no earlier moment has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameTimes {
    fps: f32,
    /// How many moments there are without the end.
    regular: usize,
    end: Option<f32>,
}

impl FrameTimes {
    /// The moments of a clip of a length in seconds, `fps` a second. In a loop, the end is the beginning and has none of its own.
    pub(crate) fn of_clip(length: f32, fps: f32, is_loop: bool) -> Self {
        // A moment that is before the end only by rounding is the end. Casts saturate.
        let before_end = (f64::from(length) * f64::from(fps) - 1e-3).ceil() as usize;
        Self {
            fps,
            regular: before_end.max(1),
            end: (length > 0.0 && !is_loop).then_some(length),
        }
    }

    /// A number of moments, `fps` a second.
    pub(crate) fn counted(count: usize, fps: f32) -> Self {
        Self {
            fps,
            regular: count,
            end: None,
        }
    }

    /// The number of moments.
    pub(crate) fn len(&self) -> usize {
        self.regular.saturating_add(usize::from(self.end.is_some()))
    }

    /// The time of a moment in seconds.
    pub(crate) fn seconds(&self, frame: usize) -> f64 {
        match self.end {
            // 1.6 instead of 1.600000023841858.
            Some(end) if frame >= self.regular => end.to_string().parse().unwrap_or_else(|_| f64::from(end)),
            _ => frame as f64 / f64::from(self.fps),
        }
    }
}

/// The time in a clip of a length at which it shows a moment: beyond its ends it holds, or it starts again in a loop.
pub(crate) fn time_in_clip(seconds: f32, length: f32, is_loop: bool) -> f32 {
    if is_loop { looped(seconds, length) } else { seconds }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(length: f32, fps: f32, is_loop: bool) -> Vec<f64> {
        let times = FrameTimes::of_clip(length, fps, is_loop);
        (0..times.len()).map(|frame| times.seconds(frame)).collect()
    }

    #[test]
    fn the_end_of_a_clip_is_a_moment_unless_it_is_the_beginning() {
        assert_eq!(times(1.0, 4.0, false), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(times(1.0, 4.0, true), [0.0, 0.25, 0.5, 0.75]);
        assert_eq!(times(0.6, 4.0, false), [0.0, 0.25, 0.5, 0.6]);
        assert_eq!(times(0.6, 4.0, true), [0.0, 0.25, 0.5]);
        // Late only by rounding, a moment is the end.
        assert_eq!(times(0.500_01, 4.0, false), [0.0, 0.25, 0.500_01]);
        assert_eq!(times(0.0, 30.0, false), [0.0]);
        assert_eq!(times(-1.0, 30.0, false), [0.0]);
    }

    #[test]
    fn a_clip_of_any_length_can_be_counted() {
        assert_eq!(FrameTimes::of_clip(f32::MAX, 1e5, false).len(), usize::MAX);
        assert_eq!(FrameTimes::counted(7, 2.0).len(), 7);
        assert_eq!(FrameTimes::counted(7, 2.0).seconds(6), 3.0);
    }
}
