//! What is asked, and how it is cut into units that can be done by themselves.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::bounds::WorldFromModel;
use crate::pose::Place;
use crate::query::{Body, PairMemory, PairQuery, QueryStats};
use crate::tree::MorphBvh;

/// How many intersecting pairs of triangles are wanted of two bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wanted {
    /// All of them.
    #[default]
    All,
    /// At most this many, those of [`PairQuery::up_to`]; [`BatchAnswers::is_truncated`](super::BatchAnswers::is_truncated) tells
    /// whether there are more.
    UpTo(usize),
    /// The first one that [`PairQuery::first`] comes to.
    First,
}

impl Wanted {
    /// How many pairs are listed at most.
    pub(super) fn limit(self) -> usize {
        match self {
            Self::All => usize::MAX,
            Self::UpTo(limit) => limit,
            Self::First => 1,
        }
    }
}

/// Two bodies of a batch, by their places in it, and what is wanted of them.
#[derive(Debug)]
pub struct PairTask<'m> {
    /// The first body.
    pub a: usize,
    /// The second one. A task with bodies that are not there, or with one body twice, finds nothing.
    pub b: usize,
    /// What is wanted.
    pub wanted: Wanted,
    /// What is remembered of these two bodies, if anything, for [`Wanted::First`]: see [`PairQuery::first_with`].
    pub memory: Option<&'m mut PairMemory>,
}

impl PairTask<'_> {
    /// Without a memory.
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

/// A pair with fewer triangles than this, both bodies together, is one unit; so is one of which only the first intersecting
/// triangles are wanted.
const LARGE: usize = 4000;
/// Parts that a large pair is cut into for each worker, so that they come out even.
const PARTS_PER_WORKER: usize = 8;

/// A piece of work.
#[derive(Debug)]
pub(super) enum Unit {
    /// A task as it is, on the bodies' own caches.
    Whole(usize),
    /// A part of a large pair, on caches of the worker's.
    Part { large: usize, part: usize },
}

/// A pair that is done in parts.
#[derive(Debug)]
pub(super) struct Large {
    task: usize,
    pub(super) sides: [LargeSide; 2],
    /// Where a walk comes to from the roots, in its order.
    front: Vec<(Place, Place)>,
    /// Of the task.
    pub(super) limit: usize,
    /// How many pairs each part has found, once it is done; one more than the limit where there are more.
    pub(super) found: Vec<AtomicUsize>,
}

/// What a worker needs of a body to make a cache of its own.
#[derive(Debug)]
pub(super) struct LargeSide {
    pub(super) bvh: Arc<MorphBvh>,
    pub(super) weights: Vec<f32>,
    pub(super) world_from_model: WorldFromModel,
}

impl Large {
    /// Where one of the parts starts from.
    pub(super) fn front(&self, part: usize) -> &[(Place, Place)] {
        let bound = |part: usize| part * self.front.len() / self.found.len();
        let range: Range<usize> = bound(part)..bound(part + 1);
        &self.front[range]
    }

    /// Whether the parts before one have already found more than may be listed, so that it can add nothing.
    pub(super) fn is_full_before(&self, part: usize) -> bool {
        let found = self.found[..part].iter().map(|found| found.load(Ordering::Relaxed));
        found.fold(0, usize::saturating_add) > self.limit
    }
}

/// The units of a batch; those of one task stand together, in the order of the walk.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub(super) units: Vec<Unit>,
    pub(super) larges: Vec<Large>,
    pub(super) stats: QueryStats,
}

impl Plan {
    /// Cuts large pairs into parts if there are too few tasks to keep the workers busy.
    pub(super) fn new(bodies: &mut [Body<'_>], tasks: &[PairTask<'_>], workers: usize, query: &mut PairQuery) -> Self {
        let mut plan = Self::default();
        for (index, task) in tasks.iter().enumerate() {
            let Ok([a, b]) = bodies.get_disjoint_mut([task.a, task.b]) else {
                continue;
            };
            let triangles = [&*a, &*b].map(|body| body.pose.bvh().model().triangle_count());
            let cut = workers > 1
                && tasks.len() < 2 * workers
                && task.wanted != Wanted::First
                && triangles.iter().sum::<usize>() >= LARGE
                && a.pose.blends_from_references()
                && b.pose.blends_from_references()
                && !query.are_collapsed(a.reborrow(), b.reborrow());
            if cut {
                plan.cut((index, task.wanted.limit()), [a, b], workers * PARTS_PER_WORKER, query);
            } else {
                plan.units.push(Unit::Whole(index));
            }
        }
        plan
    }

    /// Which task a unit is of.
    pub(super) fn task_of(&self, unit: &Unit) -> usize {
        match *unit {
            Unit::Whole(task) => task,
            Unit::Part { large, .. } => self.larges[large].task,
        }
    }

    fn cut(&mut self, (task, limit): (usize, usize), [a, b]: [&mut Body<'_>; 2], parts: usize, query: &mut PairQuery) {
        let side = |body: &Body<'_>| LargeSide {
            bvh: body.pose.bvh().clone(),
            weights: body.pose.weights().to_vec(),
            world_from_model: *body.world_from_model,
        };
        let sides = [side(a), side(b)];
        let mut front = Vec::new();
        self.stats += query.front(a.reborrow(), b.reborrow(), 4 * parts, &mut front);
        let parts = parts.min(front.len());
        let large = self.larges.len();
        self.units.extend((0..parts).map(|part| Unit::Part { large, part }));
        self.larges.push(Large {
            task,
            sides,
            front,
            limit,
            found: (0..parts).map(|_| AtomicUsize::new(0)).collect(),
        });
    }
}
