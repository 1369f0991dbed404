use std::cell::Cell;
use std::ops::ControlFlow;

use glam::DVec3;

use super::patches::{Candidate, MovingLeaves, Observer, candidates, candidates_within};
use super::{
    Features, MotionContact, MovingBody, StageCounts, TimeOfImpact, edge_edge_impact_counting,
    edge_edge_touch_counting, vertex_face_impact_counting, vertex_face_touch_counting,
};
use crate::bounds::up;
use crate::pose::Posed;
use crate::query::capped::Capped;
use crate::query::placements::Placements;
use crate::query::{PairQuery, QueryStats};
use crate::traverse::{Moving, MovingBoxes, Order, OverlapWalk, SelfStack, middle, walk_within};
use crate::tree::PatchPair;

/// Finds contacts that happen while two bodies move, or while one body deforms. Keep the query and use it again: it reuses its memory.
///
/// See the [module](crate::motion) for what moves how. Answers are exact, and touching counts, at the start and at the end of the motion, too. A
/// contact that lasts has the time at which it begins.
///
/// Times are shares of the motion, from 0 to 1. `tolerance` is the largest difference between the two ends of a time
/// ([`TimeOfImpact`]), unless these are neighbouring `f64`s. It changes how precisely you learn when something touches, never whether it
/// does. Below about 1e-9, every contact takes exact arithmetic. A negative tolerance or NaN counts as 0.
///
/// Cost: like a [`PairQuery`] in which each node has the size of the space that it sweeps through. A translation that both bodies share does
/// not count. If both bodies are as small as the rounding errors of their positions, all pairs of leaves are compared.
#[derive(Debug, Default)]
pub struct MotionQuery {
    walk: OverlapWalk,
    stack: SelfStack,
    boxes: [MovingBoxes; 2],
    leaves: [MovingLeaves; 2],
    at_start: PairQuery,
    stats: QueryStats,
}

query_basics!(MotionQuery, |query| query.stats);

type Test<'t> = dyn FnMut(Candidate, &mut QueryStats) -> ControlFlow<()> + 't;

impl MotionQuery {
    /// Appends every pair of features that touch, in the order of the walk. Each pair is listed once.
    ///
    /// Triangles that already cross each other when the motion starts are listed only if their features touch as well; use
    /// [`PairQuery`] for those.
    pub fn all(&mut self, a: MovingBody<'_>, b: MovingBody<'_>, tolerance: f64, contacts: &mut Vec<MotionContact>) {
        self.up_to(a, b, tolerance, usize::MAX, contacts);
    }

    /// Appends the first `limit` contacts of [`MotionQuery::all`]; returns whether there are more.
    pub fn up_to(
        &mut self,
        a: MovingBody<'_>,
        b: MovingBody<'_>,
        tolerance: f64,
        limit: usize,
        contacts: &mut Vec<MotionContact>,
    ) -> bool {
        let mut listed = Capped::new(contacts, limit);
        self.visit(a, b, tolerance, |contact| listed.push(contact));
        listed.is_truncated
    }

    /// Calls `visitor` for every pair of features that touch, until it breaks.
    pub fn visit(
        &mut self,
        a: MovingBody<'_>,
        b: MovingBody<'_>,
        tolerance: f64,
        mut visitor: impl FnMut(MotionContact) -> ControlFlow<()>,
    ) {
        self.run(
            a,
            b,
            &Cell::new(1.0),
            Order::Any,
            &mut |candidate, stats| match impact(&candidate, tolerance, stats) {
                Some(contact) => visitor(contact),
                None => ControlFlow::Continue(()),
            },
        );
    }

    /// Returns the first contact, if there is one.
    ///
    /// Bodies that intersect when the motion starts are in contact then ([`Features::AtStart`]). The first contact is not before
    /// `time.earliest` and not after `time.latest`. If several contacts are as early, up to the tolerance, which of them is returned depends
    /// on the tree.
    ///
    /// Cost: at first that of [`MotionQuery::all`]. When a contact is found early in the motion, the walk starts again for the time before
    /// it.
    pub fn first(&mut self, mut a: MovingBody<'_>, mut b: MovingBody<'_>, tolerance: f64) -> Option<MotionContact> {
        if let Some(early) = self.before_walk(&mut a, &mut b) {
            return early;
        }
        let mut work = self.stats;
        let mut first: Option<MotionContact> = None;
        let latest = Cell::new(1.0);
        loop {
            let (until, mut is_early) = (latest.get(), false);
            self.run(
                a.reborrow(),
                b.reborrow(),
                &latest,
                Order::Any,
                &mut |candidate, stats| {
                    first = earlier(first, &candidate, tolerance, stats);
                    latest.set(first.map_or(1.0, |first| first.time.latest));
                    // Start again: boxes over a shorter time are smaller.
                    is_early = latest.get() < 0.9 * until;
                    if is_early {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(())
                    }
                },
            );
            work += self.stats;
            if !is_early || latest.get() == 0.0 {
                break;
            }
        }
        self.stats = work;
        first
    }

    /// Returns whether the bodies touch at any time, including at the start. If not, that is a proof.
    pub fn any(&mut self, mut a: MovingBody<'_>, mut b: MovingBody<'_>) -> bool {
        if let Some(early) = self.before_walk(&mut a, &mut b) {
            return early.is_some();
        }
        let work = self.stats;
        let mut any = false;
        self.run(a, b, &Cell::new(1.0), Order::DeepestFirst, &mut |candidate, stats| {
            any = touches(&candidate, stats);
            if any {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        self.stats += work;
        any
    }

    /// Appends every pair of features of one body that touch, leaving out those that share a vertex. So a fold at a common edge is not
    /// listed, and, as for [`MotionQuery::all`], neither are parts that already cross each other ([`SelfQuery`](crate::SelfQuery)).
    ///
    /// Contacts of a vertex and a face are [`Features::VertexFace`]; of two edges, the smaller one is first.
    pub fn all_within(&mut self, body: MovingBody<'_>, tolerance: f64, contacts: &mut Vec<MotionContact>) {
        self.visit_within(body, tolerance, |contact| {
            contacts.push(contact);
            ControlFlow::Continue(())
        });
    }

    /// Calls `visitor` for the contacts of [`MotionQuery::all_within`], until it breaks.
    pub fn visit_within(
        &mut self,
        body: MovingBody<'_>,
        tolerance: f64,
        mut visitor: impl FnMut(MotionContact) -> ControlFlow<()>,
    ) {
        let bvh = body.bvh();
        let MovingBody { mut start, mut end } = body;
        let mut ends = [start.posed(), end.posed()];
        let before = [ends[0].blended(), ends[1].blended()];
        let Self {
            stack,
            boxes: [boxes, _],
            leaves: [leaves, _],
            stats,
            ..
        } = self;
        *stats = QueryStats::default();
        let (middle, drift) = drift(&mut ends);
        let mut body = Moving::new(ends, (drift, 1.0), boxes, true);
        leaves.begin(Observer::new(middle, drift, body.standing().size));
        let mut test = |candidate: Candidate, stats: &mut QueryStats| match impact(&candidate, tolerance, stats) {
            Some(contact) => visitor(contact),
            None => ControlFlow::Continue(()),
        };
        let front = bvh.self_front();
        let mut at_leaves =
            |body: &mut Moving<'_, '_>, a, b| candidates_within((body, leaves, bvh.owners()), [a, b], stats, &mut test);
        let neighbours = front.neighbours.iter().filter(|pair| pair.patches == [0; 2]);
        let of_neighbours = neighbours
            .map(PatchPair::leaves)
            .try_for_each(|[a, b]| at_leaves(&mut body, a, b));
        let tests = match of_neighbours {
            ControlFlow::Continue(()) => walk_within(&mut body, &front.apart, stack, at_leaves),
            ControlFlow::Break(()) => 0,
        };
        stats.node_tests = tests;
        let [start, end] = &body.ends;
        *stats += QueryStats::blending(before, [start.blended(), end.blended()]);
    }

    /// The answer, if it takes no walk over both motions: no contact if the bounds of the motions are apart, or contact at the start.
    fn before_walk(&mut self, a: &mut MovingBody<'_>, b: &mut MovingBody<'_>) -> Option<Option<MotionContact>> {
        self.stats = QueryStats {
            node_tests: 1,
            ..QueryStats::default()
        };
        let Self {
            walk,
            boxes: [boxes_a, boxes_b],
            ..
        } = self;
        let ends_b = [b.start.posed(), b.end.posed()];
        let mut ends_a = [a.start.posed(), a.end.posed()];
        let (_, drift) = drift(&mut ends_a);
        let moving_a = Moving::new(ends_a, (drift, 1.0), boxes_a, false);
        let moving_b = Moving::new(ends_b, (drift, 1.0), boxes_b, false);
        let placements = Placements {
            a: moving_a.standing(),
            b: moving_b.standing(),
        };
        if !placements.begin_walk(walk) {
            return Some(None);
        }
        let pair = self.at_start.first(a.start.reborrow(), b.start.reborrow());
        self.stats += self.at_start.stats();
        pair.map(|pair| {
            Some(MotionContact {
                features: Features::AtStart(pair),
                time: TimeOfImpact {
                    earliest: 0.0,
                    latest: 0.0,
                },
            })
        })
    }

    /// Calls `test` for features that may touch up to the time `latest`, until it breaks. `test` may lower `latest`.
    fn run(
        &mut self,
        mut a: MovingBody<'_>,
        mut b: MovingBody<'_>,
        latest: &Cell<f64>,
        order: Order,
        test: &mut Test<'_>,
    ) {
        let until = up(latest.get());
        let (bvh_a, bvh_b) = (a.bvh(), b.bvh());
        let mut ends_a = [a.start.posed(), a.end.posed()];
        let ends_b = [b.start.posed(), b.end.posed()];
        let before = [&ends_a[0], &ends_a[1], &ends_b[0], &ends_b[1]].map(Posed::blended);
        let Self {
            walk,
            boxes: [boxes_a, boxes_b],
            leaves: [leaves_a, leaves_b],
            stats,
            ..
        } = self;
        *stats = QueryStats::default();
        let tests_before = walk.node_tests;
        let (middle, drift) = drift(&mut ends_a);
        let mut a = Moving::new(ends_a, (drift, until), boxes_a, false);
        let mut b = Moving::new(ends_b, (drift, until), boxes_b, false);
        let placements = Placements {
            a: a.standing(),
            b: b.standing(),
        };
        if placements.begin_walk(walk) {
            let observer = Observer::new(middle, drift, a.standing().size);
            leaves_a.begin(observer);
            leaves_b.begin(observer);
            let _stopped_early = walk.run((&mut a, &mut b), &[], order, &mut |a, b, leaves| {
                if leaves.is_empty() {
                    return ControlFlow::Continue(());
                }
                let of_a = (a, &mut *leaves_a, bvh_a.owners());
                let of_b = (b, &mut *leaves_b, bvh_b.owners());
                candidates(of_a, of_b, leaves, (latest, stats), test)
            });
            stats.node_tests = walk.node_tests - tests_before;
        } else {
            stats.node_tests = 1;
        }
        let after = [&a.ends[0], &a.ends[1], &b.ends[0], &b.ends[1]].map(Posed::blended);
        *stats += QueryStats::blending(before, after);
    }
}

/// The middle of the first body when the motion starts, and how far it moves. Queries take that motion off both bodies.
fn drift(ends: &mut [Posed<'_>; 2]) -> (DVec3, DVec3) {
    let [from, to] = ends.each_mut().map(|end| middle(end.stand()));
    (from, to - from)
}

fn touches(candidate: &Candidate, stats: &mut QueryStats) -> bool {
    let [a, b, c, d] = candidate.points;
    let mut stages = StageCounts::default();
    let touches = if candidate.are_edges {
        edge_edge_touch_counting([a, b], [c, d], &mut stages)
    } else {
        vertex_face_touch_counting(a, [b, c, d], &mut stages)
    };
    count(stages, stats);
    touches
}

fn impact(candidate: &Candidate, tolerance: f64, stats: &mut QueryStats) -> Option<MotionContact> {
    let [a, b, c, d] = candidate.points;
    let mut stages = StageCounts::default();
    let time = if candidate.are_edges {
        edge_edge_impact_counting([a, b], [c, d], tolerance, &mut stages)
    } else {
        vertex_face_impact_counting(a, [b, c, d], tolerance, &mut stages)
    };
    count(stages, stats);
    time.map(|time| MotionContact {
        features: candidate.features,
        time,
    })
}

fn count(stages: StageCounts, stats: &mut QueryStats) {
    stats.feature_tests += stages.total();
    stats.undecided_by_filter += stages.exact;
}

/// The earlier one of the first contact so far and of a candidate's.
fn earlier(
    first: Option<MotionContact>,
    candidate: &Candidate,
    tolerance: f64,
    stats: &mut QueryStats,
) -> Option<MotionContact> {
    let Some(first) = first else {
        return impact(candidate, tolerance, stats);
    };
    let Some(contact) = impact(candidate, tolerance, stats) else {
        return Some(first);
    };
    // Whichever is surely over first. Nothing touches before the earlier start.
    let earliest = first.time.earliest.min(contact.time.earliest);
    let mut earlier = if contact.time.latest < first.time.latest {
        contact
    } else {
        first
    };
    earlier.time.earliest = earliest;
    Some(earlier)
}
