//! Which moment of the drawn animation a physics step uses.

use std::collections::VecDeque;
use std::time::Duration;

use bevy::time::Time;

/// The number of remembered frames.
const FRAMES: usize = 64;
/// The maximum change of the lag, as a fraction of a step.
const MAX_DRIFT: f64 = 0.01;

/// The part of the drawn animation that a step uses: the motion between two moments, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Its begin.
    pub begin: f64,
    /// Its end.
    pub end: f64,
}

impl Span {
    /// Whether this span starts where another one ended, up to rounding.
    pub fn continues(&self, end: f64) -> bool {
        (self.begin - end).abs() <= 1e-3 * (self.end - self.begin)
    }
}

/// The time of the coming step.
#[derive(Clone, Copy, Debug)]
pub struct StepTime {
    /// Its length in seconds.
    pub dt: f32,
    /// The drawn motion that it shows, if that is not what happened since the last step.
    pub span: Option<Span>,
    /// How much of what happened since the last step is motion: less than 1 after a long frame of which physics leaves out a part.
    pub share: f64,
}

/// Watches the clock of physics.
#[derive(Default)]
pub struct Watch {
    /// The time of the last look.
    last: Option<Duration>,
    /// How much longer frames were than their steps.
    strides: Recent,
}

impl Watch {
    /// Whether the clock was set since the last look, so that it does not say how much time has passed.
    pub fn was_set(&mut self, time: &Time) -> bool {
        let last = self.last.replace(time.elapsed());
        last.is_some_and(|last| last + time.delta() != time.elapsed())
    }

    /// How much of a frame's motion counts, if the frame is this much longer than its step. All of it, unless the frame is an
    /// exception among the last ones: then the rest of it is a jump, and surfaces keep their speed.
    pub fn share(&mut self, stride: f64) -> f64 {
        self.strides.push(stride);
        self.strides.usual().map_or(1.0, |usual| (usual / stride).min(1.0))
    }
}

/// The last few values.
#[derive(Default)]
struct Recent(VecDeque<f64>);

impl Recent {
    fn push(&mut self, value: f64) {
        self.0.push_back(value);
        if self.0.len() > FRAMES {
            self.0.pop_front();
        }
    }

    /// The second largest, because the largest may be an exception. The largest of two; `None` of none.
    fn usual(&self) -> Option<f64> {
        let (mut largest, mut second) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for &value in &self.0 {
            if value > largest {
                (largest, second) = (value, largest);
            } else {
                second = second.max(value);
            }
        }
        let usual = if self.0.len() < 3 { largest } else { second };
        usual.is_finite().then_some(usual)
    }
}

/// How far physics in a fixed schedule is behind what is drawn, in seconds.
///
/// A step's time is up to one frame later than the last drawn frame. Steps therefore use what was drawn slightly more than the
/// longest usual frame ago. The lag changes slowly, so that surfaces do not change their speed. After a single long frame,
/// physics waits and catches up at once.
#[derive(Default)]
pub struct Lag {
    frames: Recent,
    last_frame: Option<f64>,
    lag: f64,
    known: usize,
    /// The end of the last step's span.
    last: Option<f64>,
}

impl Lag {
    /// Records that a frame is drawn at this time.
    pub fn frame(&mut self, time: f64) {
        if let Some(last) = self.last_frame.replace(time) {
            if time < last {
                // Time was set back.
                *self = Self::default();
                self.last_frame = Some(time);
            } else if time > last {
                self.frames.push(time - last);
                self.known += 1;
            }
        }
    }

    /// The span that a step of length `dt` uses which ends at `time`. `None` before the first frame.
    pub fn span(&mut self, time: f64, dt: f64) -> Option<Span> {
        let drawn = self.last_frame?;
        let wanted = self.wanted();
        let settles = self.known < FRAMES / 4 || (self.lag - wanted).abs() > 2.0 * dt;
        let drift = if settles { f64::INFINITY } else { MAX_DRIFT * dt };
        self.lag += (wanted - self.lag).clamp(-drift, drift);
        // Frames that are still to be drawn are unknown.
        self.lag = self.lag.max(time - drawn);
        let end = time - self.lag;
        // After a long frame, the unseen part is left out instead of squeezed into one step.
        let goes_on = |last: &f64| (0.0..=1.5 * dt).contains(&(end - last));
        let begin = self.last.filter(goes_on).unwrap_or(end - dt);
        self.last = Some(end);
        Some(Span { begin, end })
    }

    /// A tenth more than usual frames are long.
    fn wanted(&self) -> f64 {
        1.1 * self.frames.usual().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs frames of these lengths against steps of 1/64 s. Returns how far each step advances in the drawn animation, relative
    /// to its length.
    fn rates(frames: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let dt = 1.0 / 64.0;
        let (mut lag, mut drawn, mut time, mut last) = (Lag::default(), 0.0, 0.0, None);
        let mut rates = Vec::new();
        for frame in frames {
            let now = drawn + frame;
            while time + dt <= now {
                time += dt;
                if let Some(Span { begin, end }) = lag.span(time, dt) {
                    assert!(end <= drawn + 1e-12, "{end} is not drawn yet, only {drawn}");
                    assert!(end - begin <= 1.5 * dt, "{}", end - begin);
                    if let Some(last) = last.replace(end) {
                        rates.push((end - last) / dt);
                    }
                }
            }
            drawn = now;
            lag.frame(drawn);
        }
        rates
    }

    #[test]
    fn steady_frames_are_seen_at_a_steady_rate() {
        for rate in [144.0, 64.0, 60.0, 50.0, 40.0, 30.0] {
            let rates = rates((0..300).map(|_| 1.0 / rate));
            assert!(rates.len() > 100);
            let worst = rates[30..].iter().map(|rate| (rate - 1.0).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-9, "{worst} at {rate} frames a second");
        }
    }

    #[test]
    fn frames_of_any_length_are_seen_at_nearly_a_steady_rate() {
        let mut state = 1_u64;
        let random = std::iter::repeat_with(|| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / 16_777_216.0
        });
        let rates = rates(random.take(3000).map(|x| 1.0 / 144.0 + x * (1.0 / 30.0 - 1.0 / 144.0)));
        let worst = rates[30..].iter().map(|rate| (rate - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst <= 0.010_001, "{worst}");
    }

    #[test]
    fn a_long_frame_is_forgotten_at_once() {
        let frames = (0..400).map(|i| if i == 200 { 0.2 } else { 1.0 / 60.0 });
        let rates = rates(frames);
        let total: f64 = rates[30..].iter().map(|rate| rate - 1.0).sum::<f64>() / 64.0;
        let after = &rates[rates.len() - 100..];
        assert!(after.iter().all(|rate| (rate - 1.0).abs() < 1e-9), "{after:?}");
        assert!(
            total.abs() < 1e-3,
            "what was waited for was not caught up with: {total}"
        );
    }

    #[test]
    fn time_that_is_set_back_starts_anew() {
        let mut lag = Lag::default();
        for i in 0..20 {
            lag.frame(10.0 + f64::from(i) / 60.0);
        }
        lag.frame(1.0);
        assert_eq!(lag.span(1.0, 0.5), Some(Span { begin: 0.5, end: 1.0 }));
    }

    #[test]
    fn a_single_long_frame_is_mostly_a_jump() {
        let mut watch = Watch::default();
        for _ in 0..10 {
            assert_eq!(watch.share(0.5), 1.0);
        }
        assert_eq!(watch.share(2.0), 0.25);
        // Two of them may be the usual ones.
        assert_eq!(watch.share(2.0), 1.0);
    }

    #[test]
    fn a_clock_that_is_set_is_noticed() {
        let (mut watch, mut time) = (Watch::default(), Time::default());
        for delta in [0, 16, 0, 33] {
            time.advance_by(Duration::from_millis(delta));
            assert!(!watch.was_set(&time));
        }
        assert!(watch.was_set(&Time::default()));
        assert!(!watch.was_set(&Time::default()));
    }
}
