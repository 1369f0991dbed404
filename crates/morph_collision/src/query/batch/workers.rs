//! The threads of a batch.

use std::thread;
use std::time::Duration;

/// The threads for a [`BatchQuery`](super::BatchQuery), or for many questions about one body
/// ([`RayQuery::closest_batch`](crate::RayQuery::closest_batch) and others). Implement it to use your engine's threads.
pub trait Workers {
    /// The number of workers, at least 1.
    fn count(&self) -> usize;

    /// Calls `work` once with each index below [`Workers::count`], in parallel if possible, and waits for all calls to return.
    /// The calls may also run one after the other: each does whatever work is left.
    fn run(&self, work: &(dyn Fn(usize) + Sync));

    /// About how long it takes until another worker has started, and until the calling thread knows that all have ended.
    ///
    /// A [`BatchQuery`](super::BatchQuery) that would save less by running on several threads runs on the calling thread, without a call
    /// of [`Workers::run`]. Many questions about one body do not ask for this time: they use several threads for about a millisecond of work
    /// or more. The default, 10 microseconds, is for threads that exist already.
    fn wake_up(&self) -> Duration {
        Duration::from_micros(10)
    }
}

/// Runs a batch on the calling thread and on new threads. Starting them costs up to a hundred microseconds per batch, so prefer
/// your engine's thread pool.
#[derive(Clone, Copy, Debug)]
pub struct ThreadWorkers {
    threads: usize,
}

impl ThreadWorkers {
    /// Creates workers for this many threads, including the calling thread; at least 1. With 1, no threads are started.
    #[must_use]
    pub fn new(threads: usize) -> Self {
        Self {
            threads: threads.max(1),
        }
    }
}

impl Workers for ThreadWorkers {
    fn count(&self) -> usize {
        self.threads
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        thread::scope(|scope| {
            for worker in 1..self.threads {
                scope.spawn(move || work(worker));
            }
            work(0);
        });
    }

    fn wake_up(&self) -> Duration {
        Duration::from_micros(100)
    }
}

/// Runs a batch on the current `rayon` pool, or on the global pool if there is none (feature `rayon`).
#[cfg(feature = "rayon")]
#[derive(Clone, Copy, Debug, Default)]
pub struct RayonWorkers;

#[cfg(feature = "rayon")]
impl Workers for RayonWorkers {
    fn count(&self) -> usize {
        rayon::current_num_threads()
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        rayon::scope(|scope| {
            for worker in 1..self.count() {
                scope.spawn(move |_| work(worker));
            }
            work(0);
        });
    }
}
