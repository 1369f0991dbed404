//! Bevy's threads, for batches of queries.

use bevy::tasks::ComputeTaskPool;
use morph_collision::Workers;

/// The threads of the [`ComputeTaskPool`], or the caller's own where there is no such pool.
///
/// The plugin uses it; so can other systems that ask with a [`BatchQuery`](morph_collision::BatchQuery) of their own.
#[derive(Clone, Copy, Debug, Default)]
pub struct TaskPoolWorkers;

impl Workers for TaskPoolWorkers {
    fn count(&self) -> usize {
        ComputeTaskPool::try_get().map_or(1, |pool| pool.thread_num().max(1))
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        let Some(pool) = ComputeTaskPool::try_get() else {
            return work(0);
        };
        pool.scope(|scope| {
            for worker in 0..self.count() {
                scope.spawn(async move { work(worker) });
            }
        });
    }
}
