//! Workers, which take units of a batch until none is left.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::Ordering;

use super::forecast::Tally;
use super::lock::locked;
use super::plan::{PairTask, Plan, Unit};
use super::schedule::Schedule;
use super::wanted::Wanted;
use crate::pose::Pose;
use crate::query::capped::Capped;
use crate::query::pairs::Start;
use crate::query::{Body, PairQuery, QueryStats, TrianglePair};

/// The maximum number of units that a worker takes from the schedule at once. Not measured; taking units costs a lock.
const MAX_UNITS_AT_ONCE: usize = 8;

/// A worker's own data.
#[derive(Debug, Default)]
pub(super) struct Worker {
    pub(super) query: PairQuery,
    /// Copies of the poses of the last large pair of which the worker took a part.
    poses: [Option<Pose>; 2],
    /// That pair, while `query` still has its boxes and patches cached.
    large: Option<usize>,
    pub(super) done: Vec<Done>,
    pub(super) found: Vec<TrianglePair>,
    pub(super) stats: QueryStats,
    pub(super) tally: Tally,
}

/// A finished unit.
#[derive(Clone, Debug)]
pub(super) struct Done {
    pub(super) unit: usize,
    /// The range of its pairs in the worker's `found`.
    pub(super) found: Range<usize>,
    /// Whether there are more.
    pub(super) is_truncated: bool,
}

/// A batch in progress.
pub(super) struct Batch<'a, 'b, 'm> {
    /// The schedule never gives out two whole tasks with a common body at the same time, so whole tasks never wait for each other. Parts
    /// lock their bodies only to copy the state of their poses.
    bodies: Vec<Mutex<&'a mut Body<'b>>>,
    /// These locks never wait for long: each whole task is done once, and parts only add their work.
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
        let locks = |unit: &Unit| unit.part.is_none().then(|| [tasks[unit.task].a, tasks[unit.task].b]);
        Self {
            workers,
            schedule: Schedule::new(plan.units.iter().map(locks).collect(), bodies.len()),
            bodies: bodies.iter_mut().map(Mutex::new).collect(),
            tasks: tasks.iter_mut().map(Mutex::new).collect(),
            plan,
        }
    }

    /// Takes units until none is left.
    pub(super) fn work(&self, worker: &mut Worker) {
        let most = (self.plan.units.len() / (4 * self.workers)).clamp(1, MAX_UNITS_AT_ONCE);
        let mut units = Vec::with_capacity(most);
        while self.schedule.take(most, &mut units) {
            for &index in &units {
                let start = worker.found.len();
                let Unit { task, part } = self.plan.units[index];
                let is_truncated = match part {
                    None => self.whole(task, worker),
                    Some(part) => self.part(task, part, worker),
                };
                worker.done.push(Done {
                    unit: index,
                    found: start..worker.found.len(),
                    is_truncated,
                });
            }
            self.schedule.free(units.drain(..));
        }
    }

    /// Does a task; returns whether there are more pairs than its limit.
    fn whole(&self, task: usize, worker: &mut Worker) -> bool {
        let mut task = locked(&self.tasks[task]);
        let [mut a, mut b] = [task.a, task.b].map(|body| locked(&self.bodies[body]));
        worker.large = None;
        let Worker {
            query,
            found,
            stats,
            tally,
            ..
        } = worker;
        let (a, b) = (a.reborrow(), b.reborrow());
        let is_truncated = match (task.wanted, &mut task.memory) {
            (Wanted::First, memory) => {
                found.extend(match memory {
                    None => query.first(a, b),
                    Some(memory) => query.first_with(memory, a, b),
                });
                false
            }
            (wanted, _) => query.up_to(a, b, wanted.limit(), found),
        };
        *stats += query.stats();
        if let Some(of_task) = &mut task.stats {
            **of_task += query.stats();
        }
        tally.add(task.wanted, true, query.stats());
        is_truncated
    }

    /// Does a part of a large pair, up to the whole task's limit; returns whether there are more pairs.
    fn part(&self, task: usize, (number, part): (usize, usize), worker: &mut Worker) -> bool {
        let large = &self.plan.large_pairs[number];
        if large.is_full_before(part) {
            return false;
        }
        let copied = |copy, body: usize| {
            let body = locked(&self.bodies[body]);
            Body::new(Pose::copied(copy, body.pose), body.world_from_model)
        };
        let ([copy_a, copy_b], [a, b]) = (&mut worker.poses, large.bodies);
        let (a, b) = (copied(copy_a, a), copied(copy_b, b));
        let before = worker.found.len();
        let mut listed = Capped::new(&mut worker.found, large.limit);
        let start = Start::Part {
            front: large.front(part),
            resume: worker.large.replace(number) == Some(number),
        };
        worker.query.run(a, b, start, &mut |pair| listed.push(pair));
        let is_truncated = listed.is_truncated;
        worker.stats += worker.query.stats();
        if let Some(of_task) = &mut locked(&self.tasks[task]).stats {
            **of_task += worker.query.stats();
        }
        worker.tally.add(Wanted::All, false, worker.query.stats());
        let found = worker.found.len() - before + usize::from(is_truncated);
        large.found[part].store(found, Ordering::Relaxed);
        is_truncated
    }
}

impl Worker {
    /// Starts a batch.
    pub(super) fn begin(&mut self) {
        self.large = None;
        self.done.clear();
        self.found.clear();
        self.stats = QueryStats::default();
        self.tally = Tally::default();
    }
}
