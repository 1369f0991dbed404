//! The walk over two moving bodies.

use std::cell::Cell;
use std::ops::ControlFlow;

use glam::DVec3;

use super::MovingBody;
use super::collapsed::CollapsedMotion;
use super::leaves::{AtTriangles, MovingLeaves, Observer, Side, triangles_of_both, triangles_of_one};
use super::limit::{Limit, LimitReached};
use super::triangle::MovingTriangle;
use crate::pose::{BoxTree, Posed};
use crate::query::QueryStats;
use crate::query::two_bodies::PlacedPair;
use crate::traverse::{Moving, MovingBoxes, Order, OverlapWalk, SelfStack, middle, walk_within};
use crate::tree::PatchPair;

/// What a walk looks for.
#[derive(Clone, Copy)]
pub(super) enum Search<'h> {
    /// All pairs.
    All,
    /// Any contact.
    Any,
    /// The first contact. Pairs that meet only later than this time are skipped; the caller lowers it when it finds a contact.
    First(&'h Cell<f64>),
}

/// The memory of walks.
#[derive(Debug, Default)]
pub(super) struct MotionWalk {
    walk: OverlapWalk,
    stack: SelfStack,
    boxes: [MovingBoxes; 2],
    leaves: [MovingLeaves; 2],
    collapsed: CollapsedMotion,
}

impl MotionWalk {
    /// The work of the last walk of two bodies that its stats do not count, in steps: for placing the triangles of collapsed bodies.
    pub(super) fn placing(&self) -> u64 {
        self.collapsed.placing()
    }

    /// Whether the bodies' bounds overlap at any time.
    pub(super) fn bounds_overlap(&mut self, a: &mut MovingBody<'_>, b: &mut MovingBody<'_>) -> bool {
        let [boxes_a, boxes_b] = &mut self.boxes;
        let ends_b = [b.start.posed(), b.end.posed()];
        let mut ends_a = [a.start.posed(), a.end.posed()];
        let (_, drift) = drift(&mut ends_a);
        let moving_a = Moving::new(ends_a, drift, boxes_a, false);
        let moving_b = Moving::new(ends_b, drift, boxes_b, false);
        placements(&moving_a, &moving_b).begin_walk(&mut self.walk, moving_a.level())
    }

    /// Calls `at_triangles` for pairs of triangles that may touch, until it breaks. Sets `stats` to the work.
    ///
    /// # Errors
    /// [`LimitReached`] after about `limit` steps.
    pub(super) fn run(
        &mut self,
        mut a: MovingBody<'_>,
        mut b: MovingBody<'_>,
        search: Search<'_>,
        limit: u64,
        stats: &mut QueryStats,
        at_triangles: &mut AtTriangles<'_>,
    ) -> Result<(), LimitReached> {
        let (bvh_a, bvh_b) = (a.bvh(), b.bvh());
        let mut ends_a = [a.start.posed(), a.end.posed()];
        let ends_b = [b.start.posed(), b.end.posed()];
        let before = [&ends_a[0], &ends_a[1], &ends_b[0], &ends_b[1]].map(Posed::blended);
        let Self {
            walk,
            boxes: [boxes_a, boxes_b],
            leaves: [leaves_a, leaves_b],
            collapsed,
            ..
        } = self;
        *stats = QueryStats::default();
        collapsed.begin();
        let (middle, drift) = drift(&mut ends_a);
        let mut a = Moving::new(ends_a, drift, boxes_a, false);
        let mut b = Moving::new(ends_b, drift, boxes_b, false);
        let always = Cell::new(1.0);
        let (order, latest) = match search {
            Search::All => (Order::Any, &always),
            Search::Any => (Order::DeepestFirst, &always),
            Search::First(latest) => (Order::EarliestFirst(latest), latest),
        };
        let limit = Limit::new(limit);
        let mut within_limit = |t: &MovingTriangle<'_>, s: &MovingTriangle<'_>, stats: &mut QueryStats| {
            at_triangles(t, s, stats)?;
            limit.check(stats)
        };
        let mut not_before = 0.0;
        if !placements(&a, &b).begin_walk(walk, a.level()) {
            stats.node_tests = 1;
        } else if !matches!(search, Search::All) && are_collapsed(&a, &b) {
            let left = collapsed.run([&mut a, &mut b], latest, &limit, stats, &mut within_limit);
            not_before = left.unwrap_or(0.0);
        } else {
            let observer = Observer::new(middle, drift, a.placed_body().size);
            leaves_a.begin(observer);
            leaves_b.begin(observer);
            let tests_before = walk.limit(limit.most);
            let _stopped_early = walk.run(&mut a, &mut b, &[], order, &mut |a, b, leaves| {
                let a = Side {
                    body: a,
                    leaves: &mut *leaves_a,
                    owners: bvh_a.owners(),
                };
                let b = Side {
                    body: b,
                    leaves: &mut *leaves_b,
                    owners: bvh_b.owners(),
                };
                triangles_of_both(a, b, leaves, latest, &limit, stats, &mut within_limit)
            });
            stats.node_tests = walk.node_tests - tests_before;
            if walk.is_cut() {
                let _cut = limit.cut();
            }
            if let Search::First(_) = search {
                not_before = walk.bound();
            }
        }
        let after = [&a.ends[0], &a.ends[1], &b.ends[0], &b.ends[1]].map(Posed::blended);
        *stats += QueryStats::blending(before, after);
        if limit.is_cut() {
            Err(LimitReached { not_before })
        } else {
            Ok(())
        }
    }

    /// Like [`MotionWalk::run`], for pairs of triangles of one body.
    pub(super) fn run_within(
        &mut self,
        body: MovingBody<'_>,
        limit: u64,
        stats: &mut QueryStats,
        at_triangles: &mut AtTriangles<'_>,
    ) -> Result<(), LimitReached> {
        let bvh = body.bvh();
        let MovingBody { mut start, mut end } = body;
        let mut ends = [start.posed(), end.posed()];
        let before = [ends[0].blended(), ends[1].blended()];
        let Self {
            stack,
            boxes: [boxes, _],
            leaves: [leaves, _],
            ..
        } = self;
        *stats = QueryStats::default();
        let (middle, drift) = drift(&mut ends);
        let mut body = Moving::new(ends, drift, boxes, true);
        leaves.begin(Observer::new(middle, drift, body.placed_body().size));
        let limit = Limit::new(limit);
        let mut within_limit = |t: &MovingTriangle<'_>, s: &MovingTriangle<'_>, stats: &mut QueryStats| {
            at_triangles(t, s, stats)?;
            limit.check(stats)
        };
        let front = bvh.self_front();
        let mut at_leaves = |body: &mut Moving<'_, '_>, a, b| {
            let side = Side {
                body,
                leaves: &mut *leaves,
                owners: bvh.owners(),
            };
            triangles_of_one(side, [a, b], stats, &mut within_limit)?;
            limit.check(stats)
        };
        let neighbours = front.neighbours.iter().filter(|pair| pair.patches == [0; 2]);
        let of_neighbours = neighbours
            .map(PatchPair::leaves)
            .try_for_each(|[a, b]| at_leaves(&mut body, a, b));
        let tests = match of_neighbours {
            ControlFlow::Continue(()) => walk_within(&mut body, &front.apart, stack, limit.most, at_leaves),
            ControlFlow::Break(()) => 0,
        };
        stats.node_tests = tests;
        let [start, end] = &body.ends;
        *stats += QueryStats::blending(before, [start.blended(), end.blended()]);
        if limit.is_cut() || tests > limit.most {
            Err(LimitReached { not_before: 0.0 })
        } else {
            Ok(())
        }
    }
}

fn placements<'a>(a: &'a Moving<'_, '_>, b: &'a Moving<'_, '_>) -> PlacedPair<'a> {
    PlacedPair {
        a: a.placed_body(),
        b: b.placed_body(),
    }
}

/// Whether boxes in `f32` cannot tell the bodies' parts apart at the start or at the end, because the bodies are too small there, or the
/// numbers too large.
fn are_collapsed(a: &Moving<'_, '_>, b: &Moving<'_, '_>) -> bool {
    let is_bounded = |body: &Moving<'_, '_>| body.placed_body().bounds.size().is_finite();
    !is_bounded(a) || !is_bounded(b) || (0..2).any(|end| PlacedPair::are_small([a.resolution(end), b.resolution(end)]))
}

/// The middle of the first body when the motion starts, and how far it moves. Queries take that motion off both bodies.
fn drift(ends: &mut [Posed<'_>; 2]) -> (DVec3, DVec3) {
    let [from, to] = ends.each_mut().map(|end| middle(end.placed_body()));
    (from, to - from)
}
