//! Who does the work.

use std::num::NonZeroUsize;
use std::thread;

/// Threads that a [`BatchQuery`](super::BatchQuery) may use: the one thing an engine has to provide to spread queries over its own
/// threads.
///
/// ```
/// use morph_collision::Workers;
///
/// /// Not a good idea, but it works.
/// struct TwoNewThreads;
///
/// impl Workers for TwoNewThreads {
///     fn count(&self) -> usize {
///         2
///     }
///
///     fn run(&self, work: &(dyn Fn(usize) + Sync)) {
///         std::thread::scope(|scope| {
///             scope.spawn(|| work(0));
///             scope.spawn(|| work(1));
///         });
///     }
/// }
/// ```
pub trait Workers {
    /// How many may work at the same time, at least 1.
    fn count(&self) -> usize;

    /// Calls `work` once with each number below [`Workers::count`], at the same time if it can be, and returns when all calls
    /// have returned. Calls may also come one after the other: each does what is left to do.
    fn run(&self, work: &(dyn Fn(usize) + Sync));
}

/// The caller's own thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct OneThread;

impl Workers for OneThread {
    fn count(&self) -> usize {
        1
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        work(0);
    }
}

/// So many threads, the caller's among them; the others are started for each batch, which costs some tens of microseconds.
/// An engine has threads that wait for work: use those.
#[derive(Clone, Copy, Debug)]
pub struct ThreadWorkers {
    /// How many.
    pub threads: NonZeroUsize,
}

impl Workers for ThreadWorkers {
    fn count(&self) -> usize {
        self.threads.get()
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        thread::scope(|scope| {
            for worker in 1..self.threads.get() {
                scope.spawn(move || work(worker));
            }
            work(0);
        });
    }
}

/// The threads of the `rayon` pool that the caller runs in, the global one if it runs in none (feature `rayon`).
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
