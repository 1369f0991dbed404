//! A stopwatch that does not run while the thread waits for a processor, where the system can tell.

use std::time::{Duration, Instant};

/// A moment, by the best clock there is.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    wall: Instant,
    processor: Option<Duration>,
}

impl Stopwatch {
    /// Starts.
    #[must_use]
    pub fn start() -> Self {
        let wall = Instant::now();
        let processor = processor_time();
        Self { wall, processor }
    }

    /// Time on a processor since the start; wall time where that is not known.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        match (self.processor, processor_time()) {
            (Some(start), Some(end)) => end.saturating_sub(start),
            _ => self.wall.elapsed(),
        }
    }

    /// What a stopwatch shows that is stopped at once: the median of many.
    #[must_use]
    pub fn idle() -> Duration {
        let mut readings: Vec<Duration> = (0..1001).map(|_| Self::start().elapsed()).collect();
        readings.sort_unstable();
        readings[readings.len() / 2]
    }
}

/// This thread's time on a processor.
#[cfg(unix)]
fn processor_time() -> Option<Duration> {
    use rustix::time::{ClockId, clock_gettime};
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).ok()
}

#[cfg(not(unix))]
fn processor_time() -> Option<Duration> {
    None
}
