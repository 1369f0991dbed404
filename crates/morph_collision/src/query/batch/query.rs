//! Runs a batch and gathers its answers.

use std::ops::Range;
use std::sync::Mutex;

use super::forecast::Forecast;
use super::lock::{locked, unlocked};
use super::plan::{PairTask, Plan, Team, Unit};
use super::work::{Batch, Worker};
use super::workers::Workers;
use crate::query::{Body, QueryStats, TrianglePair};

/// Finds the intersecting triangles of many pairs of bodies on several threads. Keep the query and use it again: it reuses its memory.
///
/// On any number of threads, it finds the same pairs as [`PairQuery`](crate::PairQuery), in the same order. Pairs without a common body
/// run in parallel. If there are few pairs, large ones are cut into parts. A batch runs on the calling thread if the previous ones suggest
/// that it ends before other threads have started.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// use morph_collision::batch::{BatchQuery, PairTask, ThreadWorkers, Wanted};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let mut poses = [Pose::new(bvh.clone()), Pose::new(bvh.clone()), Pose::new(bvh)];
/// poses[1].set_weights(&[2.0])?; // lifts the triangle to z = 2
/// let mut bodies: Vec<Body<'_>> = poses.iter_mut().map(|pose| Body::new(pose, &WorldFromModel::IDENTITY)).collect();
/// let mut tasks = [(0, 1), (0, 2)].map(|(a, b)| PairTask::new(a, b, Wanted::All));
///
/// let mut query = BatchQuery::new();
/// let answers = query.run(&mut bodies, &mut tasks, &ThreadWorkers::new(2));
/// assert!(answers.get(0).is_empty());
/// assert_eq!(answers.get(1).len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct BatchQuery {
    /// One entry per worker. Each reuses its memory.
    workers: Vec<Mutex<Worker>>,
    found: Vec<TrianglePair>,
    answers: Vec<Answer>,
    forecast: Forecast,
}

/// The answer to a task: its range in the list of all found pairs, and whether there are more.
type Answer = (Range<usize>, bool);

/// The answers of a [`BatchQuery`], indexed by task.
#[derive(Clone, Copy, Debug)]
pub struct BatchAnswers<'a> {
    found: &'a [TrianglePair],
    answers: &'a [Answer],
    stats: QueryStats,
}

impl<'a> BatchAnswers<'a> {
    /// Returns the work of all threads together. For a cut pair, the nodes and vertices that each part blends are counted.
    #[must_use]
    pub fn stats(&self) -> QueryStats {
        self.stats
    }

    /// Returns the pairs that a task found; empty if there is no such task.
    #[must_use]
    pub fn get(&self, task: usize) -> &'a [TrianglePair] {
        let answer = self.answers.get(task);
        answer.map_or(&[], |(range, _)| &self.found[range.clone()])
    }

    /// Returns whether a task with [`Wanted::UpTo`](super::Wanted::UpTo) has more pairs than its limit.
    #[must_use]
    pub fn is_truncated(&self, task: usize) -> bool {
        self.answers.get(task).is_some_and(|(_, is_truncated)| *is_truncated)
    }

    /// Iterates over the pairs of every task, in the order of the tasks.
    pub fn iter(&self) -> impl Iterator<Item = &'a [TrianglePair]> {
        let answers = *self;
        (0..self.answers.len()).map(move |task| answers.get(task))
    }
}

impl BatchQuery {
    /// Creates an empty query. It allocates on first use.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Runs every task.
    pub fn run(
        &mut self,
        bodies: &mut [Body<'_>],
        tasks: &mut [PairTask<'_>],
        workers: &dyn Workers,
    ) -> BatchAnswers<'_> {
        let count = workers.count().max(1);
        if self.workers.len() < count {
            self.workers.resize_with(count, Default::default);
        }
        for worker in &mut self.workers {
            unlocked(worker).begin();
        }
        let team = Team {
            count,
            wake_up: workers.wake_up(),
        };
        let query = &mut unlocked(&mut self.workers[0]).query;
        let plan = Plan::new(bodies, tasks, team, &self.forecast, query);
        let batch = Batch::new(bodies, tasks, &plan, count);
        let own = &self.workers;
        let work = |worker: usize| {
            // An index out of range has nothing to do: the other workers do all the work.
            if let Some(worker) = own.get(worker) {
                batch.work(&mut locked(worker));
            }
        };
        if plan.is_parallel {
            workers.run(&work);
        } else {
            work(0);
        }
        self.gather(&plan, tasks)
    }

    /// Collects what the workers found in the order of tasks and units, up to each task's limit.
    fn gather(&mut self, plan: &Plan, tasks: &[PairTask<'_>]) -> BatchAnswers<'_> {
        let mut stats = plan.stats;
        let mut tally = plan.tally;
        let mut all_done = Vec::with_capacity(plan.units.len());
        for (index, worker) in self.workers.iter_mut().enumerate() {
            let worker = unlocked(worker);
            stats += worker.stats;
            tally.join(&worker.tally);
            all_done.extend(worker.done.drain(..).map(|done| (index, done)));
        }
        all_done.sort_unstable_by_key(|(_, done)| done.unit);
        self.found.clear();
        self.answers.clear();
        self.answers.resize(tasks.len(), (0..0, false));
        for (worker, done) in all_done {
            let task = plan.units[done.unit].task;
            let (range, is_truncated) = &mut self.answers[task];
            if range.start == range.end {
                range.start = self.found.len();
            }
            let room = tasks[task].wanted.limit() - (self.found.len() - range.start);
            let found = &unlocked(&mut self.workers[worker]).found[done.found];
            self.found.extend_from_slice(&found[..room.min(found.len())]);
            *is_truncated |= done.is_truncated || found.len() > room;
            range.end = self.found.len();
        }
        // How much of a cut task was left out when its limit was reached depends on the threads.
        let is_cut_short = |unit: &Unit| unit.part.is_some() && self.answers[unit.task].1;
        if !plan.units.iter().any(is_cut_short) {
            self.forecast.learn(&tally);
        }
        BatchAnswers {
            found: &self.found,
            answers: &self.answers,
            stats,
        }
    }
}
