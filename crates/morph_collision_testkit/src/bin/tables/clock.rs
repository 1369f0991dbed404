//! A stopwatch that does not run while the thread waits for a processor, where the system can tell.

use std::time::{Duration, Instant};

/// A moment, by the best clock there is.
pub(crate) struct Stopwatch {
    wall: Instant,
    processor: Option<Duration>,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        let processor = processor_time();
        Self {
            wall: Instant::now(),
            processor,
        }
    }

    /// Time on a processor since the start; wall time where that is not known.
    pub(crate) fn elapsed(&self) -> Duration {
        let wall = self.wall.elapsed();
        match (self.processor, processor_time()) {
            (Some(start), Some(end)) => end - start,
            _ => wall,
        }
    }
}

/// This thread's time on a processor (Linux). Yielding makes the kernel bring its books up to date.
fn processor_time() -> Option<Duration> {
    std::thread::yield_now();
    let stats = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = stats.split_whitespace().next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}
