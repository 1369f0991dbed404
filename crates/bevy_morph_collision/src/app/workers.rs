//! Runs batches of queries on Bevy's threads.

use bevy::tasks::ComputeTaskPool;
use morph_collision::batch::Workers;

/// The threads of the [`ComputeTaskPool`], or the calling thread if that pool does not exist.
///
/// The plugin uses them. You can use them too, for your own [`BatchQuery`](morph_collision::batch::BatchQuery).
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
