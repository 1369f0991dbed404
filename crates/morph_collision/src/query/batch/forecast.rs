//! Predicts how long the tasks of a batch take, to decide whether other threads are worth waking up.
//!
//! All times are estimates from counts, in nanoseconds, so the same batches lead to the same decisions on every machine. Decisions change
//! no answer.

use std::time::Duration;

use super::wanted::Wanted;
use crate::query::QueryStats;

/// Nanoseconds for each task, each test of two nodes and each test of two triangles, blending included. Fitted to times of the pass-through
/// and of dolphins (docs/tried.md).
const PER_TASK: u64 = 500;
const PER_NODE_TEST: u64 = 12;
const PER_TRIANGLE_TEST: u64 = 3;
/// The forecast for a task, and for each triangle of its bodies if all pairs are wanted, before any task was counted.
const UNKNOWN_TASK: u64 = 2000;
const UNKNOWN_TRIANGLE: u64 = 1;
/// Threads must save this many times what waking them up costs.
const MARGIN: u64 = 2;

/// Tasks that end at the first pair, and all others. They are counted separately.
const KINDS: usize = 2;

fn kind(wanted: Wanted) -> usize {
    usize::from(wanted == Wanted::First)
}

/// What a worker has done in one batch, by kind of task.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    tasks: [u64; KINDS],
    nanoseconds: [u64; KINDS],
}

impl Tally {
    /// Adds the counts of a task, or of a part of a task that was added before; then `is_new` is false.
    pub(super) fn add(&mut self, wanted: Wanted, is_new: bool, stats: QueryStats) {
        let QueryStats {
            node_tests,
            triangle_tests,
            ..
        } = stats;
        self.tasks[kind(wanted)] += u64::from(is_new);
        self.nanoseconds[kind(wanted)] += PER_NODE_TEST * node_tests + PER_TRIANGLE_TEST * triangle_tests;
    }

    pub(super) fn join(&mut self, other: &Self) {
        for kind in 0..KINDS {
            self.tasks[kind] += other.tasks[kind];
            self.nanoseconds[kind] += other.nanoseconds[kind];
        }
    }
}

/// The forecast for each kind of task: the average of the last batch that had any.
#[derive(Debug, Default)]
pub(super) struct Forecast {
    per_task: [Option<u64>; KINDS],
}

impl Forecast {
    /// The forecast for a task with bodies of this many triangles together.
    pub(super) fn task(&self, wanted: Wanted, triangles: usize) -> u64 {
        self.per_task[kind(wanted)].unwrap_or_else(|| match wanted {
            Wanted::First => UNKNOWN_TASK,
            Wanted::All | Wanted::UpTo(_) => UNKNOWN_TASK + UNKNOWN_TRIANGLE * triangles as u64,
        })
    }

    /// Learns from a batch.
    pub(super) fn learn(&mut self, tally: &Tally) {
        for ((per_task, tasks), nanoseconds) in self.per_task.iter_mut().zip(tally.tasks).zip(tally.nanoseconds) {
            if let Some(average) = nanoseconds.checked_div(tasks) {
                *per_task = Some(PER_TASK + average);
            }
        }
    }
}

/// Whether it is worth waking up other workers to save this much time.
pub(super) fn is_worth(saved: u64, wake_up: Duration) -> bool {
    u128::from(saved) > u128::from(MARGIN) * wake_up.as_nanos()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stats(node_tests: u64, triangle_tests: u64) -> QueryStats {
        QueryStats {
            node_tests,
            triangle_tests,
            ..QueryStats::default()
        }
    }

    #[test]
    fn a_forecast_is_the_average_of_the_last_batch_with_tasks_of_that_kind() {
        let mut forecast = Forecast::default();
        let first = forecast.task(Wanted::First, 1000);
        assert!(forecast.task(Wanted::All, 1000) > forecast.task(Wanted::All, 10));
        for (node_tests, expected) in [(40, 20), (400, 200)] {
            let (mut one, mut other) = (Tally::default(), Tally::default());
            one.add(Wanted::All, true, stats(node_tests, 0));
            other.add(Wanted::UpTo(3), true, stats(0, 10));
            one.join(&other);
            forecast.learn(&one);
            let of_task = PER_TASK + PER_NODE_TEST * expected + PER_TRIANGLE_TEST * 5;
            assert_eq!(forecast.task(Wanted::All, 1_000_000), of_task);
            assert_eq!(forecast.task(Wanted::First, 1000), first);
        }
        let mut parts = Tally::default();
        parts.add(Wanted::First, true, stats(10, 0));
        parts.add(Wanted::First, false, stats(10, 0));
        forecast.learn(&parts);
        assert_eq!(forecast.task(Wanted::First, 1), PER_TASK + 20 * PER_NODE_TEST);
    }

    #[test]
    fn threads_that_wake_up_at_once_are_always_worth_it_and_slow_ones_only_for_much_work() {
        assert!(is_worth(1, Duration::ZERO) && !is_worth(0, Duration::ZERO));
        assert!(!is_worth(40_000, Duration::from_micros(20)) && is_worth(40_001, Duration::from_micros(20)));
        assert!(!is_worth(u64::MAX, Duration::MAX));
    }
}
