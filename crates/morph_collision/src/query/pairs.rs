use std::ops::ControlFlow;

use super::body::Body;
use super::capped::Capped;
use super::collapsed::{Collapsed, CollapsedTests};
use super::memory::PairMemory;
use super::patches::{LeafTests, Patches, intersecting_pairs};
use super::places::Places;
use super::stats::QueryStats;
use crate::pose::{Place, Posed};
use crate::traverse::{Culls, Meeting, PairWalk, Stack};
use crate::tree::Leaf;

/// Two intersecting triangles, each by its number in its own mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrianglePair {
    /// A triangle of the first body.
    pub triangle_a: u32,
    /// A triangle of the second body.
    pub triangle_b: u32,
}

/// Asks which triangles of two bodies intersect; holds the memory that queries reuse.
///
/// The answer is exact over the posed vertices in world space, see the crate's introduction; touching counts. It does not
/// depend on the tree, and the same triangles come out whichever body is named first.
#[derive(Debug, Default)]
pub struct PairQuery {
    stack: Stack,
    culls: Culls,
    leaves_a: Patches,
    leaves_b: Patches,
    collapsed: Collapsed,
}

impl PairQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends every pair of intersecting triangles, in the order of the walk.
    ///
    /// Bodies that collapse to a point touch in every pair of their triangles; [`PairQuery::up_to`] bounds the list.
    pub fn all(&mut self, a: Body<'_>, b: Body<'_>, pairs: &mut Vec<TrianglePair>) -> QueryStats {
        self.visit(a, b, |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        })
    }

    /// Appends at most `limit` pairs of intersecting triangles, the first ones of [`PairQuery::all`]; says whether there are more.
    ///
    /// The walk ends at the first pair that there is no room for. So two bodies that touch everywhere, as two that were scaled to
    /// a point, do not list the product of their triangles. Which pairs come first depends on the tree and on the order of the
    /// bodies.
    pub fn up_to(
        &mut self,
        limit: usize,
        a: Body<'_>,
        b: Body<'_>,
        pairs: &mut Vec<TrianglePair>,
    ) -> (bool, QueryStats) {
        let mut listed = Capped::new(pairs, limit);
        let stats = self.visit(a, b, |pair| listed.push(pair));
        (listed.is_truncated, stats)
    }

    /// The first pair of intersecting triangles that a walk comes to which looks first where nodes reach deepest into each other.
    pub fn first(&mut self, a: Body<'_>, b: Body<'_>) -> (Option<TrianglePair>, QueryStats) {
        let mut first = None;
        let (stats, _) = self.run(a, b, Start::Deepest, &mut |pair| {
            first = Some(pair);
            ControlFlow::Break(())
        });
        (first, stats)
    }

    /// How many pairs of triangles intersect.
    pub fn count(&mut self, a: Body<'_>, b: Body<'_>) -> (u64, QueryStats) {
        let mut count = 0;
        let stats = self.visit(a, b, |_| {
            count += 1;
            ControlFlow::Continue(())
        });
        (count, stats)
    }

    /// Whether any triangles intersect.
    pub fn any(&mut self, a: Body<'_>, b: Body<'_>) -> (bool, QueryStats) {
        let (first, stats) = self.first(a, b);
        (first.is_some(), stats)
    }

    /// Calls `visitor` for every pair of intersecting triangles, in the order of the walk, until it breaks.
    pub fn visit(
        &mut self,
        a: Body<'_>,
        b: Body<'_>,
        mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        self.run(a, b, Start::Roots, &mut visitor).0
    }

    /// As [`PairQuery::visit`], from some node pairs on.
    pub(super) fn visit_from(
        &mut self,
        front: &[(Place, Place)],
        a: Body<'_>,
        b: Body<'_>,
        mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        if front.is_empty() {
            return QueryStats::default();
        }
        self.run(a, b, Start::Front(front), &mut visitor).0
    }

    /// Whether the bodies are too small to be culled; then there is no walk over their trees.
    pub(super) fn are_collapsed(&self, a: Body<'_>, b: Body<'_>) -> bool {
        let places = Places {
            world_from_a: a.world_from_model,
            world_from_b: b.world_from_model,
        };
        places.are_collapsed(&mut a.pose.posed(), &mut b.pose.posed())
    }

    /// The node pairs that the walk comes to from the roots, in its order, once there are so many: each can be walked from by
    /// itself.
    pub(super) fn front(
        &mut self,
        a: Body<'_>,
        b: Body<'_>,
        least: usize,
        front: &mut Vec<(Place, Place)>,
    ) -> QueryStats {
        let mut nothing = |_| ControlFlow::Continue(());
        self.run(a, b, Start::Expand(least, front), &mut nothing).0
    }

    /// A pair of intersecting triangles if there is any: of the leaves in which one was found the last time, if they still
    /// have one, and otherwise that of [`PairQuery::first`].
    pub fn first_with(
        &mut self,
        memory: &mut PairMemory,
        mut a: Body<'_>,
        mut b: Body<'_>,
    ) -> (Option<TrianglePair>, QueryStats) {
        let mut first = None;
        let mut visitor = |pair| {
            first = Some(pair);
            ControlFlow::Break(())
        };
        let mut stats = QueryStats::default();
        if let Some(leaves) = memory.witness_of(&a, &b) {
            stats = self
                .run(a.reborrow(), b.reborrow(), Start::Leaves(leaves), &mut visitor)
                .0;
        }
        if first.is_none() {
            let (more, witness) = self.run(a, b, Start::Deepest, &mut |pair| {
                first = Some(pair);
                ControlFlow::Break(())
            });
            stats += more;
            memory.remember(witness);
        }
        (first, stats)
    }

    /// Calls `visitor` for pairs of intersecting triangles until it breaks; returns the leaves at which it did, if they were
    /// walked to.
    fn run(
        &mut self,
        a: Body<'_>,
        b: Body<'_>,
        start: Start<'_>,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> (QueryStats, Option<(Leaf, Leaf)>) {
        let places = Places {
            world_from_a: a.world_from_model,
            world_from_b: b.world_from_model,
        };
        let (a, b) = (&mut a.pose.posed(), &mut b.pose.posed());
        let before = [a.blended(), b.blended()];
        let Self {
            stack,
            culls,
            leaves_a,
            leaves_b,
            collapsed,
        } = self;
        let roots_meet = matches!(start, Start::Leaves(_)) || places.begin_culls(a, b, culls);
        if !roots_meet && !matches!(start, Start::Expand(..)) {
            let stats = QueryStats {
                node_tests: 1,
                ..QueryStats::blending(before, [a.blended(), b.blended()])
            };
            return (stats, None);
        }
        if roots_meet && matches!(start, Start::Roots | Start::Deepest) && places.are_collapsed(a, b) {
            let mut tests = CollapsedTests::default();
            collapsed.place(a, b, &places);
            let _stopped_early = collapsed.intersecting(&mut tests, visitor);
            let stats = QueryStats {
                node_tests: tests.nodes,
                triangle_tests: tests.triangles,
                undecided_by_filter: tests.undecided_by_filter,
                ..QueryStats::blending(before, [a.blended(), b.blended()])
            };
            return (stats, None);
        }
        let level = a.level;
        let (mut tests, mut node_tests, mut stopped_at) = (LeafTests::default(), 0, None);
        places.begin_leaves(a, b, [leaves_a, leaves_b]);
        let mut at_leaves = |a: &mut Posed<'_>, b: &mut Posed<'_>, of_a, of_b| {
            let (block_a, block_b) = (leaves_a.read(a, of_a), leaves_b.read(b, of_b));
            let flow = intersecting_pairs(level, (leaves_a, block_a), (leaves_b, block_b), &mut tests, visitor);
            if flow.is_break() {
                stopped_at = Some((of_a, of_b));
            }
            flow
        };
        if let Start::Leaves((of_a, of_b)) = start {
            let _only_these = at_leaves(a, b, of_a, of_b);
        } else {
            let mut walk = PairWalk {
                a: &mut *a,
                b: &mut *b,
                rule: &Meeting { culls: culls.into() },
                roots_meet,
                a_from_b_scale: places.a_from_b_scale(),
                deepest_first: matches!(start, Start::Deepest),
                node_tests: 0,
            };
            let _stopped_early = match start {
                Start::Front(front) => walk.run(stack, front, at_leaves),
                Start::Expand(least, front) => {
                    *front = walk.front(stack, least);
                    ControlFlow::Continue(())
                }
                _ => walk.run(stack, &[], at_leaves),
            };
            node_tests = walk.node_tests;
        }
        let stats = QueryStats {
            node_tests,
            triangle_tests: tests.triangles,
            undecided_by_filter: tests.undecided_by_filter,
            ..QueryStats::blending(before, [a.blended(), b.blended()])
        };
        (stats, stopped_at)
    }
}

/// What a query starts from.
enum Start<'a> {
    Roots,
    /// The roots; nodes that reach deepest into each other come first.
    Deepest,
    /// Node pairs that an earlier walk came to.
    Front(&'a [(Place, Place)]),
    /// No walk: these leaves alone.
    Leaves((Leaf, Leaf)),
    /// The roots; it only goes on until there are so many node pairs, which go there.
    Expand(usize, &'a mut Vec<(Place, Place)>),
}
