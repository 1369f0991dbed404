//! What a worker does: units of a batch, one after the other, until none is left.

use std::ops::Range;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::plan::{LargeSide, PairTask, Plan, Unit, Wanted};
use super::schedule::Schedule;
use crate::pose::Pose;
use crate::query::capped::Capped;
use crate::query::{Body, PairQuery, QueryStats, TrianglePair};

/// Pairs that a worker takes from the schedule at a time, at most.
const MOST_AT_ONCE: usize = 8;

/// What a worker has of its own.
#[derive(Debug, Default)]
pub(super) struct Worker {
    pub(super) query: PairQuery,
    /// For parts of large pairs.
    poses: [Option<Pose>; 2],
    pub(super) done: Vec<Done>,
    pub(super) found: Vec<TrianglePair>,
    pub(super) stats: QueryStats,
}

/// A unit that was done.
#[derive(Clone, Debug)]
pub(super) struct Done {
    pub(super) unit: usize,
    /// Where its pairs are in the worker's `found`.
    pub(super) found: Range<usize>,
    /// Whether there are more.
    pub(super) is_truncated: bool,
}

pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(super) fn unlocked(worker: &mut Mutex<Worker>) -> &mut Worker {
    worker.get_mut().unwrap_or_else(PoisonError::into_inner)
}

/// A batch while it is worked on.
pub(super) struct Batch<'a, 'b, 'm> {
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
    pub(super) fn new(
        bodies: &'a mut [Body<'b>],
        tasks: &'a mut [PairTask<'m>],
        plan: &'a Plan,
        workers: usize,
    ) -> Self {
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
    pub(super) fn work(&self, worker: &mut Worker) {
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
    pub(super) fn begin(&mut self) {
        self.done.clear();
        self.found.clear();
        self.stats = QueryStats::default();
    }
}
