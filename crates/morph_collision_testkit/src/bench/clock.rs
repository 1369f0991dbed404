//! A stopwatch that stops while the thread waits for a processor, if the system can tell.

use std::time::{Duration, Instant};

/// A point in time, measured with the best available clock.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    wall: Instant,
    processor: Option<Duration>,
}

impl Stopwatch {
    /// Starts the stopwatch.
    #[must_use]
    pub fn start() -> Self {
        let wall = Instant::now();
        let processor = processor_time();
        Self { wall, processor }
    }

    /// Processor time since the start; wall time if processor time is not available.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        match (self.processor, processor_time()) {
            (Some(start), Some(end)) => end.saturating_sub(start),
            _ => self.wall.elapsed(),
        }
    }

    /// The reading of a stopwatch that is stopped at once: the median of many.
    #[must_use]
    pub fn idle() -> Duration {
        let mut readings: Vec<Duration> = (0..1001).map(|_| Self::start().elapsed()).collect();
        readings.sort_unstable();
        readings[readings.len() / 2]
    }
}

/// This thread's processor time.
#[cfg(unix)]
fn processor_time() -> Option<Duration> {
    use rustix::time::{ClockId, clock_gettime};
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).ok()
}

#[cfg(not(unix))]
fn processor_time() -> Option<Duration> {
    None
}
