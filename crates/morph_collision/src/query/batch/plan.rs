//! Splits a batch into units of work that can run independently.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::query::{Body, PairMemory, PairQuery, QueryStats};
use crate::tree::NodeId;

/// How many of two bodies' intersecting triangle pairs to find.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wanted {
    /// All of them.
    #[default]
    All,
    /// At most this many: the pairs that [`PairQuery::up_to`] finds. [`BatchAnswers::is_truncated`](super::BatchAnswers::is_truncated)
    /// says whether there are more.
    UpTo(usize),
    /// One: the pair that [`PairQuery::first`] finds.
    First,
}

impl Wanted {
    /// The maximum length of the list.
    #[must_use]
    pub fn limit(self) -> usize {
        match self {
            Self::All => usize::MAX,
            Self::UpTo(limit) => limit,
            Self::First => 1,
        }
    }
}

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
}

impl PairTask<'_> {
    /// Creates a task without memory.
    #[must_use]
    pub fn new(a: usize, b: usize, wanted: Wanted) -> Self {
        Self {
            a,
            b,
            wanted,
            memory: None,
        }
    }
}

/// Pairs with fewer triangles in both bodies together are not cut. Not measured; small pairs are finished before another thread wakes up.
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
}

impl Plan {
    /// Plans a batch. Cuts large pairs into parts if there are too few tasks to keep the workers busy.
    pub(super) fn new(bodies: &mut [Body<'_>], tasks: &[PairTask<'_>], workers: usize, query: &mut PairQuery) -> Self {
        let mut plan = Self::default();
        for (task, &PairTask { a, b, wanted, .. }) in tasks.iter().enumerate() {
            let Ok([a, b]) = bodies.get_disjoint_mut([a, b]) else {
                continue;
            };
            let triangles = [&*a, &*b].map(|body| body.pose.bvh().model().triangle_count());
            let cut = workers > 1
                && tasks.len() < 2 * workers
                && wanted != Wanted::First
                && triangles.iter().sum::<usize>() >= MIN_TRIANGLES_TO_CUT
                && !query.are_collapsed(a.reborrow(), b.reborrow());
            if !cut {
                plan.units.push(Unit { task, part: None });
                continue;
            }
            let parts = workers * PARTS_PER_WORKER;
            let front = query.front(a.reborrow(), b.reborrow(), 4 * parts);
            plan.stats += query.stats();
            let (large, parts) = (plan.large_pairs.len(), parts.min(front.len()));
            let parts_of_large = (0..parts).map(|part| Some((large, part)));
            plan.units.extend(parts_of_large.map(|part| Unit { task, part }));
            plan.large_pairs.push(Large {
                bodies: [tasks[task].a, tasks[task].b],
                front,
                limit: wanted.limit(),
                found: (0..parts).map(|_| AtomicUsize::new(0)).collect(),
            });
        }
        plan
    }
}
