//! The query for intersecting triangles of two bodies.

use std::ops::ControlFlow;

use super::memory::PairMemory;
use super::patch_cache::{Patches, Side, intersecting_pairs};
use crate::pose::Posed;
use crate::query::body::Body;
use crate::query::capped::Capped;
use crate::query::stats::QueryStats;
use crate::query::triangle_pair::TrianglePair;
use crate::query::two_bodies::{Collapsed, Neighbourhood, PlacedPair};
use crate::traverse::{Order, OverlapWalk};
use crate::tree::{Leaf, NodeId};

/// Finds the intersecting triangles of two bodies. Keep the query and use it again: it reuses its memory.
///
/// The answer is exact for the posed vertices in world space (see the crate's introduction); touching counts. It does not depend
/// on the tree. If you swap the bodies, you get the same pairs of triangles.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// # use morph_collision::*;
/// // A triangle, and a target that lifts it.
/// let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
/// let above = WorldFromModel::new(Affine3A::from_translation(Vec3::Z))?;
/// let (mut query, mut pairs) = (PairQuery::new(), Vec::new());
/// assert!(!query.any(Body::new(&mut a, &WorldFromModel::IDENTITY), Body::new(&mut b, &above)));
/// a.set_weights(&[1.0])?;
/// query.all(Body::new(&mut a, &WorldFromModel::IDENTITY), Body::new(&mut b, &above), &mut pairs);
/// assert_eq!(pairs, [TrianglePair { triangle_a: 0, triangle_b: 0 }]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct PairQuery {
    walk: OverlapWalk,
    patches: [Patches; 2],
    /// Whether `patches` are those of the bodies of the current walk.
    are_patches_current: bool,
    collapsed: Collapsed,
    stats: QueryStats,
}

query_basics!(PairQuery, |query| query.stats);

impl PairQuery {
    /// Appends every pair of intersecting triangles, in the order of the walk.
    ///
    /// If both bodies collapse to the same point, all pairs of their triangles intersect; use [`PairQuery::up_to`] to limit the list.
    pub fn all(&mut self, a: Body<'_>, b: Body<'_>, pairs: &mut Vec<TrianglePair>) {
        self.up_to(a, b, usize::MAX, pairs);
    }

    /// Appends the first `limit` pairs of [`PairQuery::all`]; returns whether there are more.
    ///
    /// The walk ends at the first pair that does not fit. Which pairs come first depends on the tree and on the order of the
    /// bodies.
    pub fn up_to(&mut self, a: Body<'_>, b: Body<'_>, limit: usize, pairs: &mut Vec<TrianglePair>) -> bool {
        let mut listed = Capped::new(pairs, limit);
        self.visit(a, b, |pair| listed.push(pair));
        listed.is_truncated
    }

    /// Returns an intersecting pair, if there is one. The walk visits the nodes that overlap deepest first and ends at the first pair.
    pub fn first(&mut self, a: Body<'_>, b: Body<'_>) -> Option<TrianglePair> {
        self.first_from_roots(a, b).0
    }

    /// Returns whether any triangles intersect.
    pub fn any(&mut self, a: Body<'_>, b: Body<'_>) -> bool {
        self.first(a, b).is_some()
    }

    /// Calls `visitor` for every pair of intersecting triangles, in the order of the walk, until it breaks.
    pub fn visit(&mut self, a: Body<'_>, b: Body<'_>, mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>) {
        self.run(a, b, Start::Roots, &mut visitor);
    }

    /// Like [`PairQuery::first`], but first tries the leaves that intersected last time.
    ///
    /// The memory never changes whether a pair is found, but it can change which one.
    pub fn first_with(&mut self, memory: &mut PairMemory, mut a: Body<'_>, mut b: Body<'_>) -> Option<TrianglePair> {
        let mut stats = QueryStats::default();
        if let Some(leaves) = memory.witness_of(&a, &b) {
            let first = self.first_at(a.reborrow(), b.reborrow(), leaves);
            if first.is_some() {
                return first;
            }
            stats = self.stats;
        }
        let (first, witness) = self.first_from_roots(a, b);
        self.stats += stats;
        memory.remember(witness);
        first
    }

    /// Tests the triangles of two leaves. This does not need the bounds of the bodies, which are expensive for skinned ones.
    fn first_at(&mut self, mut a: Body<'_>, mut b: Body<'_>, leaves: (Leaf, Leaf)) -> Option<TrianglePair> {
        let (a, b) = (&mut a.posed(), &mut b.posed());
        let before = [a.blended(), b.blended()];
        let Self { patches, stats, .. } = self;
        *stats = QueryStats::default();
        let size = a.world_from_model.scale() * f64::from(a.model.base_reach());
        let neighbourhood = Neighbourhood::new(a.world_from_model.translation(), size);
        let [patches_a, patches_b] = patches;
        patches_a.begin(&neighbourhood, a.world_from_model);
        patches_b.begin(&neighbourhood, b.world_from_model);
        let mut first = None;
        let (mut side_a, mut side_b) = (Side::new(a, patches_a), Side::new(b, patches_b));
        let _stopped_early = intersecting_pairs(&mut side_a, &mut side_b, &[leaves], stats, &mut |pair| {
            first = Some(pair);
            ControlFlow::Break(())
        });
        *stats += QueryStats::blending(before, [a.blended(), b.blended()]);
        first
    }

    fn first_from_roots(&mut self, a: Body<'_>, b: Body<'_>) -> (Option<TrianglePair>, Option<(Leaf, Leaf)>) {
        let mut first = None;
        let witness = self.run(a, b, Start::Deepest, &mut |pair| {
            first = Some(pair);
            ControlFlow::Break(())
        });
        (first, witness)
    }

    /// Whether the bodies are too small for culling. Queries then do not walk the trees.
    pub(in crate::query) fn are_collapsed(&self, mut a: Body<'_>, mut b: Body<'_>) -> bool {
        PlacedPair::of(&mut a.posed(), &mut b.posed()).are_collapsed()
    }

    /// Expands the roots, level by level, into at least `least` node pairs (fewer if there are not that many), in the order of
    /// the walk. Each can be walked on its own.
    pub(in crate::query) fn front(&mut self, a: Body<'_>, b: Body<'_>, least: usize) -> Vec<(NodeId, NodeId)> {
        let mut front = Vec::new();
        let mut ignore = |_| ControlFlow::Continue(());
        let start = Start::Expand {
            least,
            front: &mut front,
        };
        self.run(a, b, start, &mut ignore);
        front
    }

    /// Calls `visitor` for intersecting pairs until it breaks. Returns the leaves at which it broke, if the start is
    /// [`Start::Deepest`], which handles leaf pairs one at a time.
    pub(in crate::query) fn run(
        &mut self,
        mut a: Body<'_>,
        mut b: Body<'_>,
        start: Start<'_>,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> Option<(Leaf, Leaf)> {
        let (a, b) = (&mut a.posed(), &mut b.posed());
        let before = [a.blended(), b.blended()];
        let (part, resumes) = match start {
            Start::Part { front, resume } => (front, resume),
            _ => (&[][..], false),
        };
        let Self {
            walk,
            patches: [patches_a, patches_b],
            are_patches_current,
            collapsed,
            stats,
        } = self;
        *stats = QueryStats::default();
        let tests_before = walk.node_tests;
        let mut stopped_at = None;
        let level = a.level;
        let pair = PlacedPair::of(a, b);
        let roots_overlap = resumes || pair.begin_walk(walk, level);
        if !roots_overlap {
            stats.node_tests = 1;
        } else if matches!(start, Start::Roots | Start::Deepest) && pair.are_collapsed() {
            collapsed.fill(a, b);
            let _stopped_early = collapsed.intersecting(stats, visitor);
        } else {
            *are_patches_current &= resumes;
            let mut at_leaves = |a: &mut Posed<'_>, b: &mut Posed<'_>, leaves: &[(Leaf, Leaf)]| {
                if !*are_patches_current {
                    let neighbourhood = PlacedPair::of(a, b).neighbourhood();
                    patches_a.begin(&neighbourhood, a.world_from_model);
                    patches_b.begin(&neighbourhood, b.world_from_model);
                    *are_patches_current = true;
                }
                let mut a = Side::new(a, patches_a);
                let mut b = Side::new(b, patches_b);
                let flow = intersecting_pairs(&mut a, &mut b, leaves, stats, visitor);
                if flow.is_break() {
                    stopped_at = leaves.last().copied();
                }
                flow
            };
            let _stopped_early = match start {
                Start::Deepest => walk.run(&mut *a, &mut *b, &[], Order::DeepestFirst, &mut at_leaves),
                Start::Roots | Start::Part { .. } => walk.run(&mut *a, &mut *b, part, Order::Any, &mut at_leaves),
                Start::Expand { least, front } => {
                    *front = walk.front(a, b, least);
                    ControlFlow::Continue(())
                }
            };
            stats.node_tests = walk.node_tests - tests_before;
        }
        *stats += QueryStats::blending(before, [a.blended(), b.blended()]);
        stopped_at
    }
}

/// Where a query starts.
pub(in crate::query) enum Start<'a> {
    /// The roots, in any order.
    Roots,
    /// The roots; nodes that overlap deepest come first.
    Deepest,
    /// Some of the node pairs of [`PairQuery::front`].
    Part {
        front: &'a [(NodeId, NodeId)],
        /// Whether the previous query was for the same bodies in the same state, so that its cached boxes and patches stay valid.
        resume: bool,
    },
    /// The roots, expanded into at least this many node pairs, which are stored in `front`.
    Expand {
        least: usize,
        front: &'a mut Vec<(NodeId, NodeId)>,
    },
}
