use std::ops::ControlFlow;

use super::body::{Body, with_walkable_pair};
use super::capped::Capped;
use super::collapsed::{Collapsed, CollapsedTests};
use super::memory::PairMemory;
use super::patches::{LeafTests, Patches, intersecting_pairs};
use super::places::Places;
use super::stats::QueryStats;
use crate::bounds::Volume;
use crate::pose::Place;
use crate::traverse::{AnyCulls, Meeting, PairWalk, Stack, Walkable};
use crate::tree::Leaf;

/// Two intersecting triangles, each by its number in its own mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrianglePair {
    /// A triangle of the first body.
    pub triangle_a: u32,
    /// A triangle of the second body.
    pub triangle_b: u32,
}

/// Along how many axes the nodes of two trees are compared; no answer depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SeparatingAxes {
    /// The axes of both bodies: cheap, and usually enough.
    #[default]
    Lite,
    /// And the nine products of an axis of one and an axis of the other, on boxes around the nodes' volumes: fewer nodes and
    /// triangles are looked at, each at a higher price. Most is saved where flat or long boxes lie across each other; measure
    /// before you choose it.
    Full,
}

/// Asks which triangles of two bodies intersect; holds the memory that queries reuse.
///
/// The answer is exact over the posed vertices in world space, see the crate's introduction; touching counts. It does not
/// depend on the tree, and the same triangles come out whichever body is named first.
#[derive(Debug, Default)]
pub struct PairQuery {
    stack: Stack,
    culls: AnyCulls,
    leaves_a: Patches,
    leaves_b: Patches,
    collapsed: Collapsed,
    axes: SeparatingAxes,
    /// Whether the query that runs ends with the first pair.
    only_first: bool,
}

impl PairQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The same query with other axes to compare nodes along.
    #[must_use]
    pub fn with_axes(mut self, axes: SeparatingAxes) -> Self {
        self.axes = axes;
        self
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
        self.only_first = true;
        let stats = self.visit(a, b, |pair| {
            first = Some(pair);
            ControlFlow::Break(())
        });
        self.only_first = false;
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
        self.dispatch(a, b, Start::Roots, &mut visitor)
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
        self.dispatch(a, b, Start::Front(front), &mut visitor)
    }

    /// Whether the bodies are too small to be culled; then there is no walk over their trees.
    pub(super) fn are_collapsed(&self, a: Body<'_>, b: Body<'_>) -> bool {
        let places = Places {
            world_from_a: a.world_from_model,
            world_from_b: b.world_from_model,
        };
        with_walkable_pair!(a.pose.posed(), b.pose.posed(), (a, b) => places.are_collapsed(&mut a, &mut b))
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
        self.dispatch(a, b, Start::Expand(least, front), &mut nothing)
    }

    /// As [`PairQuery::visit`], with what is remembered of the same pair of bodies in earlier frames.
    ///
    /// The answer is the same; see [`PairMemory`] for when it is found faster.
    pub fn visit_with(
        &mut self,
        memory: &mut PairMemory,
        a: Body<'_>,
        b: Body<'_>,
        mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        if memory.proves_apart(&a, &b) {
            return QueryStats::default();
        }
        let mut touched = false;
        memory.begin();
        let Body {
            pose: pose_a,
            world_from_model: world_from_a,
        } = a;
        let Body {
            pose: pose_b,
            world_from_model: world_from_b,
        } = b;
        let bodies = (
            Body::new(&mut *pose_a, world_from_a),
            Body::new(&mut *pose_b, world_from_b),
        );
        let stats = self.dispatch(bodies.0, bodies.1, Start::Memory(memory), &mut |pair| {
            touched = true;
            visitor(pair)
        });
        memory.finish(
            touched,
            Body::new(pose_a, world_from_a),
            Body::new(pose_b, world_from_b),
        );
        stats
    }

    /// A pair of intersecting triangles if there is any: of the leaves in which one was found the last time, if they still
    /// have one, and otherwise the first that the walk comes to.
    ///
    /// See [`PairMemory`] for what it remembers; without [`Remember::witness`](crate::Remember) it is [`PairQuery::first`].
    pub fn first_with(
        &mut self,
        memory: &mut PairMemory,
        a: Body<'_>,
        b: Body<'_>,
    ) -> (Option<TrianglePair>, QueryStats) {
        let mut first = None;
        let mut visitor = |pair| {
            first = Some(pair);
            ControlFlow::Break(())
        };
        let mut stats = QueryStats::default();
        if let Some(leaves) = memory.witness_of(&a, &b) {
            let (a, b) = (
                Body::new(a.pose, a.world_from_model),
                Body::new(b.pose, b.world_from_model),
            );
            stats += self.dispatch(a, b, Start::Leaves(leaves), &mut visitor);
        }
        if first.is_none() {
            self.only_first = true;
            stats += self.visit_with(memory, a, b, |pair| {
                first = Some(pair);
                ControlFlow::Break(())
            });
            self.only_first = false;
        }
        (first, stats)
    }

    fn dispatch(
        &mut self,
        a: Body<'_>,
        b: Body<'_>,
        start: Start<'_>,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        let places = Places {
            world_from_a: a.world_from_model,
            world_from_b: b.world_from_model,
        };
        with_walkable_pair!(a.pose.posed(), b.pose.posed(), (a, b) => self.walk(&mut a, &mut b, &places, start, visitor))
    }

    fn walk<V: Volume, T: Walkable<Kind = V>>(
        &mut self,
        a: &mut T,
        b: &mut T,
        places: &Places<'_>,
        start: Start<'_>,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> QueryStats {
        let before = [a.blended(), b.blended()];
        let Self {
            stack,
            culls,
            leaves_a,
            leaves_b,
            collapsed,
            axes,
            only_first,
        } = self;
        let level = a.level();
        let (mut tests, mut node_tests, mut stopped_at) = (LeafTests::default(), 0, None);
        let culls = culls.of::<V>();
        let (roots_meet, cross) = match start {
            Start::Leaves(_) => (true, None),
            _ => places.begin_culls(a, b, *axes, culls),
        };
        if !roots_meet && matches!(start, Start::Roots | Start::Front(_)) {
            return QueryStats {
                node_tests: 1,
                ..QueryStats::blending(before, [a.blended(), b.blended()])
            };
        }
        let whole = matches!(start, Start::Roots | Start::Memory(_));
        if roots_meet && whole && places.are_collapsed(a, b) {
            let mut tests = CollapsedTests::default();
            collapsed.place(a, b, places);
            let _stopped_early = collapsed.intersecting(&mut tests, visitor);
            if let Start::Memory(memory) = start {
                memory.forget_walk();
            }
            return QueryStats {
                node_tests: tests.nodes,
                triangle_tests: tests.triangles,
                undecided_by_filter: tests.undecided_by_filter,
                ..QueryStats::blending(before, [a.blended(), b.blended()])
            };
        }
        places.begin_leaves(a, b, [leaves_a, leaves_b]);
        let mut at_leaves = |a: &mut T, b: &mut T, of_a, of_b| {
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
                rule: &Meeting {
                    culls: culls.into(),
                    cross: cross.as_ref(),
                },
                roots_meet,
                a_from_b_scale: places.a_from_b_scale(),
                deepest_first: *only_first,
                node_tests: 0,
                trace: None,
            };
            let _stopped_early = match start {
                Start::Roots | Start::Leaves(_) => walk.run(stack, &[], at_leaves),
                Start::Front(front) => walk.run(stack, front, at_leaves),
                Start::Expand(least, front) => {
                    *front = walk.front(stack, least);
                    ControlFlow::Continue(())
                }
                Start::Memory(PairMemory {
                    remember,
                    front,
                    trace,
                    witness,
                    ..
                }) => {
                    // Tracing takes time.
                    walk.trace = (remember.front || remember.separation).then_some(trace);
                    let flow = walk.run(stack, front, at_leaves);
                    *witness = stopped_at;
                    flow
                }
            };
            node_tests = walk.node_tests;
        }
        let after = [a.blended(), b.blended()];
        QueryStats {
            node_tests,
            triangle_tests: tests.triangles,
            undecided_by_filter: tests.undecided_by_filter,
            ..QueryStats::blending(before, after)
        }
    }
}

/// What a walk starts from, and what becomes of it.
enum Start<'a> {
    Roots,
    /// The front of the walk before; what this one leaves goes there.
    Memory(&'a mut PairMemory),
    Front(&'a [(Place, Place)]),
    /// No walk: these leaves alone.
    Leaves((Leaf, Leaf)),
    /// The roots; it only goes on until there are so many node pairs, which go there.
    Expand(usize, &'a mut Vec<(Place, Place)>),
}
