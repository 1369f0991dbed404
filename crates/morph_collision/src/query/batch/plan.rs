//! Splits a batch into units of work that can run independently.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use super::forecast::{Forecast, Tally, is_worth};
use super::wanted::Wanted;
use crate::query::{Body, PairMemory, PairQuery, QueryStats};
use crate::tree::NodeId;

/// A pair of bodies in a batch, by index, and what to find.
#[derive(Debug)]
pub struct PairTask<'m> {
    /// The first body.
    pub a: usize,
    /// The second body. A task finds nothing if its indices are equal or out of range.
    pub b: usize,
    /// What to find.
    pub wanted: Wanted,
    /// The pair's memory for [`Wanted::First`]; see [`PairQuery::first_with`].
    pub memory: Option<&'m mut PairMemory>,
    /// Where to add the work of this task. For a cut pair, it is that of its parts.
    pub stats: Option<&'m mut QueryStats>,
}

impl PairTask<'_> {
    /// Creates a task without memory, whose work is not told.
    #[must_use]
    pub fn new(a: usize, b: usize, wanted: Wanted) -> Self {
        Self {
            a,
            b,
            wanted,
            memory: None,
            stats: None,
        }
    }
}

/// Pairs with fewer triangles in both bodies together are not cut, even if all workers are awake. Not measured.
const MIN_TRIANGLES_TO_CUT: usize = 4000;
/// Parts per worker; several, to balance parts of different cost. Not measured.
const PARTS_PER_WORKER: usize = 8;

/// A piece of work: a whole task on the bodies' own poses, or a part of a cut pair on the worker's copies of the poses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unit {
    pub(super) task: usize,
    /// The index in [`Plan::large_pairs`] and the index of the part; `None` for a whole task.
    pub(super) part: Option<(usize, usize)>,
}

/// A pair that is cut into parts.
#[derive(Debug)]
pub(super) struct Large {
    pub(super) bodies: [usize; 2],
    /// The node pairs to walk, in order.
    front: Vec<(NodeId, NodeId)>,
    /// The task's limit.
    pub(super) limit: usize,
    /// The number of pairs that each finished part has found; one more than the limit if there are more.
    pub(super) found: Vec<AtomicUsize>,
}

impl Large {
    /// The node pairs of one part.
    pub(super) fn front(&self, part: usize) -> &[(NodeId, NodeId)] {
        let bound = |part: usize| part * self.front.len() / self.found.len();
        &self.front[bound(part)..bound(part + 1)]
    }

    /// Whether earlier parts have already found more than the limit.
    pub(super) fn is_full_before(&self, part: usize) -> bool {
        let found = self.found[..part].iter().map(|found| found.load(Ordering::Relaxed));
        found.fold(0, usize::saturating_add) > self.limit
    }
}

/// The units of a batch. The units of one task are adjacent and in the order of the walk.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub(super) units: Vec<Unit>,
    pub(super) large_pairs: Vec<Large>,
    pub(super) stats: QueryStats,
    /// The cut tasks, without their parts.
    pub(super) tally: Tally,
    /// Whether other workers are worth waking up.
    pub(super) is_parallel: bool,
}

/// The workers of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Team {
    pub(super) count: usize,
    pub(super) wake_up: Duration,
}

impl Plan {
    /// Plans a batch. Cuts large pairs into parts if there are too few tasks to keep the workers busy.
    pub(super) fn new(
        bodies: &mut [Body<'_>],
        tasks: &[PairTask<'_>],
        team: Team,
        forecast: &Forecast,
        query: &mut PairQuery,
    ) -> Self {
        let mut plan = Self::default();
        let workers = team.count as u64;
        // The expected time of all tasks, and of those that cannot run at the same time because they share a body.
        let (mut total, mut of_bodies) = (0, vec![0; bodies.len()]);
        for (task, &PairTask { a, b, wanted, .. }) in tasks.iter().enumerate() {
            let Ok([body_a, body_b]) = bodies.get_disjoint_mut([a, b]) else {
                continue;
            };
            let triangles = [&*body_a, &*body_b].map(|body| body.pose.bvh().model().triangle_count());
            let triangles = triangles.iter().sum::<usize>();
            let expected = forecast.task(wanted, triangles);
            total += expected;
            let cut = tasks.len() < 2 * team.count
                && wanted != Wanted::First
                && triangles >= MIN_TRIANGLES_TO_CUT
                && is_worth(expected - expected / workers, team.wake_up)
                && !query.are_collapsed(body_a.reborrow(), body_b.reborrow());
            if cut {
                plan.cut(task, [a, b], [body_a, body_b], wanted, team.count, query);
            } else {
                plan.units.push(Unit { task, part: None });
                of_bodies[a] += expected;
                of_bodies[b] += expected;
            }
        }
        let busiest = of_bodies.into_iter().max().unwrap_or(0);
        let saved = total - (total / workers).max(busiest).min(total);
        plan.is_parallel = plan.units.len() > 1 && is_worth(saved, team.wake_up);
        plan
    }

    /// Adds the parts of a task.
    fn cut(
        &mut self,
        task: usize,
        bodies: [usize; 2],
        [a, b]: [&mut Body<'_>; 2],
        wanted: Wanted,
        workers: usize,
        query: &mut PairQuery,
    ) {
        let parts = workers * PARTS_PER_WORKER;
        let front = query.front(a.reborrow(), b.reborrow(), 4 * parts);
        self.stats += query.stats();
        self.tally.add(wanted, true, query.stats());
        let (large, parts) = (self.large_pairs.len(), parts.min(front.len()));
        let parts_of_large = (0..parts).map(|part| Some((large, part)));
        self.units.extend(parts_of_large.map(|part| Unit { task, part }));
        self.large_pairs.push(Large {
            bodies,
            front,
            limit: wanted.limit(),
            found: (0..parts).map(|_| AtomicUsize::new(0)).collect(),
        });
    }
}
