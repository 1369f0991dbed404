use std::iter;
use std::ops::Range;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::plan::{LargeSide, PairTask, Plan, Unit, Wanted};
use super::schedule::Schedule;
use super::workers::Workers;
use crate::pose::Pose;
use crate::query::capped::Capped;
use crate::query::{Body, PairQuery, QueryStats, TrianglePair};

/// Asks many pairs of bodies for their intersecting triangles, on several threads; holds the memory that queries reuse.
///
/// What it finds is what [`PairQuery`] finds, in the same order, on any number of threads. Pairs that share no body are looked
/// at at the same time; where there are few, large ones are cut into parts.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())?);
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

/// Pairs that a worker takes from the schedule at a time, at most.
const MOST_AT_ONCE: usize = 8;

/// What a worker has of its own.
#[derive(Debug, Default)]
struct Worker {
    query: PairQuery,
    /// For parts of large pairs.
    poses: [Option<Pose>; 2],
    done: Vec<Done>,
    found: Vec<TrianglePair>,
    stats: QueryStats,
}

/// A unit that was done.
#[derive(Clone, Debug)]
struct Done {
    unit: usize,
    /// Where its pairs are in the worker's `found`.
    found: Range<usize>,
    /// Whether there are more.
    is_truncated: bool,
}

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

    /// Whether a task with [`Wanted::UpTo`] found more than it may list.
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
        let worker = || {
            Mutex::new(Worker {
                query: PairQuery::new(),
                ..Worker::default()
            })
        };
        if self.workers.len() < count {
            self.workers.resize_with(count, worker);
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

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unlocked(worker: &mut Mutex<Worker>) -> &mut Worker {
    worker.get_mut().unwrap_or_else(PoisonError::into_inner)
}

/// A batch while it is worked on.
struct Batch<'a, 'b, 'm> {
    /// Locked without waiting: the schedule keeps units apart that need the same one.
    bodies: Vec<Mutex<&'a mut Body<'b>>>,
    /// The bodies of each task.
    pairs: Vec<[usize; 2]>,
    /// Locked without waiting: a task is done once.
    tasks: Vec<Mutex<&'a mut PairTask<'m>>>,
    plan: &'a Plan,
    schedule: Schedule,
    workers: usize,
}

impl<'a, 'b, 'm> Batch<'a, 'b, 'm> {
    fn new(bodies: &'a mut [Body<'b>], tasks: &'a mut [PairTask<'m>], plan: &'a Plan, workers: usize) -> Self {
        Self {
            workers,
            schedule: Schedule::new(plan.units.len(), bodies.len()),
            bodies: bodies.iter_mut().map(Mutex::new).collect(),
            pairs: tasks.iter().map(|task| [task.a, task.b]).collect(),
            tasks: tasks.iter_mut().map(Mutex::new).collect(),
            plan,
        }
    }

    /// Does units until none is left.
    fn work(&self, worker: &mut Worker) {
        let bodies_of = |unit: usize| match self.plan.units[unit] {
            Unit::Whole(task) => Some(self.pairs[task]),
            Unit::Part { .. } => None,
        };
        let most = (self.plan.units.len() / (4 * self.workers)).clamp(1, MOST_AT_ONCE);
        let mut units = Vec::with_capacity(most);
        while self.schedule.take(most, bodies_of, &mut units) {
            for &index in &units {
                let start = worker.found.len();
                let is_truncated = match self.plan.units[index] {
                    Unit::Whole(task) => self.whole(task, worker),
                    Unit::Part { large, part } => self.part(large, part, worker),
                };
                worker.done.push(Done {
                    unit: index,
                    found: start..worker.found.len(),
                    is_truncated,
                });
            }
            self.schedule.free(units.drain(..).filter_map(bodies_of));
        }
    }

    /// Says whether there are more pairs than the task may list.
    fn whole(&self, task: usize, worker: &mut Worker) -> bool {
        let [mut a, mut b] = self.pairs[task].map(|body| locked(&self.bodies[body]));
        let mut task = locked(&self.tasks[task]);
        let Worker {
            query, found, stats, ..
        } = worker;
        let (a, b) = (a.reborrow(), b.reborrow());
        let mut listed = Capped::new(found, task.wanted.limit());
        *stats += match (task.wanted, &mut task.memory) {
            (Wanted::First, memory) => {
                let (first, stats) = match memory {
                    None => query.first(a, b),
                    Some(memory) => query.first_with(memory, a, b),
                };
                let _ = first.map(|pair| listed.push(pair));
                stats
            }
            _ => query.visit(a, b, |pair| listed.push(pair)),
        };
        listed.is_truncated
    }

    /// The pairs of a part, as many as the whole task may list; says whether there are more.
    fn part(&self, large: usize, part: usize, worker: &mut Worker) -> bool {
        let large = &self.plan.larges[large];
        if large.is_full_before(part) {
            return false;
        }
        let Worker {
            query,
            poses: [pose_a, pose_b],
            found,
            stats,
            ..
        } = worker;
        let [side_a, side_b] = &large.sides;
        let bodies = (
            Body::new(side_a.pose(pose_a), &side_a.world_from_model),
            Body::new(side_b.pose(pose_b), &side_b.world_from_model),
        );
        let before = found.len();
        let mut listed = Capped::new(found, large.limit);
        *stats += query.visit_from(large.front(part), bodies.0, bodies.1, |pair| listed.push(pair));
        let is_truncated = listed.is_truncated;
        let found = found.len() - before + usize::from(is_truncated);
        large.found[part].store(found, Ordering::Relaxed);
        is_truncated
    }
}

impl LargeSide {
    /// A cache of the worker's for this body; one that is there already keeps what it has blended if it can.
    fn pose<'p>(&self, room: &'p mut Option<Pose>) -> &'p mut Pose {
        let kept = room.take().filter(|pose| Arc::ptr_eq(pose.bvh(), &self.bvh));
        let pose = room.insert(kept.unwrap_or_else(|| Pose::new(self.bvh.clone())));
        // Always taken: the body's own pose has taken them.
        let _ = pose.set_weights(&self.weights);
        pose
    }
}

impl Worker {
    fn begin(&mut self) {
        self.done.clear();
        self.found.clear();
        self.stats = QueryStats::default();
    }
}
