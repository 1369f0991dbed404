use std::iter;
use std::sync::Mutex;

use super::plan::{PairTask, Plan};
use super::work::{Batch, Worker, locked, unlocked};
use super::workers::Workers;
use crate::query::{Body, QueryStats, TrianglePair};

/// Asks many pairs of bodies for their intersecting triangles, on several threads; holds the memory that queries reuse.
///
/// What it finds is what [`PairQuery`](crate::PairQuery) finds, in the same order, on any number of threads. Pairs that share no body are looked
/// at at the same time; where there are few, large ones are cut into parts.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let mut poses = [Pose::new(bvh.clone()), Pose::new(bvh.clone()), Pose::new(bvh)];
/// poses[1].set_weights(&[2.0])?; // lifts the triangle to z = 2
/// let mut bodies: Vec<Body<'_>> = poses.iter_mut().map(|pose| Body::new(pose, &WorldFromModel::IDENTITY)).collect();
/// let mut tasks = [(0, 1), (0, 2)].map(|(a, b)| PairTask::new(a, b, Wanted::All));
///
/// let mut query = BatchQuery::new();
/// let answers = query.run(&mut bodies, &mut tasks, &OneThread);
/// assert!(answers.get(0).is_empty());
/// assert_eq!(answers.get(1).len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct BatchQuery {
    /// By worker, so that each finds its memory again.
    workers: Vec<Mutex<Worker>>,
    found: Vec<TrianglePair>,
    ends: Vec<usize>,
    truncated: Vec<bool>,
}

/// So few pairs are done sooner than another thread wakes up.
const FEW: usize = 16;

/// What a [`BatchQuery`] found, by task.
#[derive(Clone, Copy, Debug)]
pub struct BatchAnswers<'a> {
    found: &'a [TrianglePair],
    ends: &'a [usize],
    truncated: &'a [bool],
    /// What it took, all threads together. Volumes and vertices that parts of a large pair share are counted for each.
    pub stats: QueryStats,
}

impl<'a> BatchAnswers<'a> {
    /// What a task found; nothing if there is no such task.
    #[must_use]
    pub fn get(&self, task: usize) -> &'a [TrianglePair] {
        let Some(&end) = self.ends.get(task) else { return &[] };
        let start = task.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.found[start..end]
    }

    /// Whether a task with [`Wanted::UpTo`](super::Wanted::UpTo) found more than it may list.
    #[must_use]
    pub fn is_truncated(&self, task: usize) -> bool {
        self.truncated.get(task).copied().unwrap_or(false)
    }

    /// What every task found, in order.
    pub fn iter(&self) -> impl Iterator<Item = &'a [TrianglePair]> {
        let answers = *self;
        (0..self.ends.len()).map(move |task| answers.get(task))
    }
}

impl BatchQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Does every task.
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
        let plan = Plan::new(bodies, tasks, count, &mut unlocked(&mut self.workers[0]).query);
        let limits: Vec<usize> = tasks.iter().map(|task| task.wanted.limit()).collect();
        let batch = Batch::new(bodies, tasks, &plan, count);
        let own = &self.workers;
        let work = |worker: usize| {
            // A number out of range has nothing to do: the others do it all.
            if let Some(worker) = own.get(worker) {
                batch.work(&mut locked(worker));
            }
        };
        if plan.larges.is_empty() && plan.units.len() < FEW {
            work(0);
        } else {
            workers.run(&work);
        }
        self.gather(&plan, &limits)
    }

    /// Puts what the workers found in the order of tasks and units, each task's up to its limit.
    fn gather(&mut self, plan: &Plan, limits: &[usize]) -> BatchAnswers<'_> {
        let mut by_unit = vec![None; plan.units.len()];
        let mut stats = plan.stats;
        for (index, worker) in self.workers.iter_mut().enumerate() {
            let worker = unlocked(worker);
            stats += worker.stats;
            for done in worker.done.drain(..) {
                let unit = done.unit;
                by_unit[unit] = Some((index, done));
            }
        }
        self.found.clear();
        self.ends.clear();
        self.truncated.clear();
        self.truncated.resize(limits.len(), false);
        for (unit, place) in plan.units.iter().zip(by_unit) {
            let task = plan.task_of(unit);
            self.ends
                .extend(iter::repeat_n(self.found.len(), task.saturating_sub(self.ends.len())));
            let Some((worker, done)) = place else { continue };
            let start = task.checked_sub(1).map_or(0, |before| self.ends[before]);
            let room = limits[task].saturating_sub(self.found.len() - start);
            let found = &unlocked(&mut self.workers[worker]).found[done.found];
            self.found.extend_from_slice(&found[..room.min(found.len())]);
            self.truncated[task] |= done.is_truncated || found.len() > room;
        }
        self.ends.resize(limits.len(), self.found.len());
        BatchAnswers {
            found: &self.found,
            ends: &self.ends,
            truncated: &self.truncated,
            stats,
        }
    }
}
