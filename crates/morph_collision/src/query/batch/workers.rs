//! The threads of a batch.

use std::thread;

/// The threads of a [`BatchQuery`](super::BatchQuery). Implement it to run batches on your engine's threads.
pub trait Workers {
    /// The number of workers, at least 1.
    fn count(&self) -> usize;

    /// Calls `work` once with each index below [`Workers::count`], in parallel if possible, and waits for all calls to return.
    /// Calls may also run one after the other: each does whatever is left to do.
    fn run(&self, work: &(dyn Fn(usize) + Sync));
}

/// The calling thread and new ones, started for each batch at a cost of some tens of microseconds. Prefer the threads of your engine.
#[derive(Clone, Copy, Debug)]
pub struct ThreadWorkers {
    threads: usize,
}

impl ThreadWorkers {
    /// Workers on this many threads, the calling one included; at least 1. One thread starts no others.
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
}

/// The current `rayon` pool, the global one outside of a pool (feature `rayon`).
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
