use std::cell::Cell;
use std::ops::ControlFlow;

use glam::DVec3;

use super::ball::BallBox;
use super::candidate::{Candidate, MovingTriangle};
use super::patches::{MovingLeaves, Observer, Test, candidates, candidates_within, triangles_at_box};
use super::{BallImpact, Features, MotionContact, MovingBall, MovingBody};
use crate::pose::Posed;
use crate::query::capped::Capped;
use crate::query::placements::Placements;
use crate::query::{PairQuery, QueryStats, TrianglePair};
use crate::traverse::{Moving, MovingBoxes, Order, OverlapWalk, SelfStack, middle, walk_within};
use crate::tree::{Leaf, PatchPair};

/// Finds contacts that happen while two bodies move, or while one body deforms. Keep the query and use it again: it reuses its memory.
///
/// See the [module](crate::motion) for what moves how. Answers are exact, but for those about balls, and touching counts, at the start and
/// at the end of the motion, too. A contact that lasts has the time at which it begins.
///
/// Times are shares of the motion, from 0 to 1. `tolerance` is the largest difference between the two ends of a time
/// ([`TimeOfImpact`](super::TimeOfImpact)), unless these are neighbouring `f64`s. The ends never differ by more than `2^-30`. A smaller
/// tolerance changes how precisely you learn when something touches, never whether it does. Below about 1e-12, every contact takes exact
/// arithmetic. A negative tolerance or NaN counts as 0.
///
/// Cost: like a [`PairQuery`] in which each node has the size of the space that it sweeps through, and pairs of nodes that are never at the
/// same place at the same time are left out. A translation that both bodies share does not count. If both bodies are as small as the
/// rounding errors of their positions, all pairs of leaves are compared.
///
/// ```
/// use std::sync::Arc;
/// use glam::{Affine3A, DVec3, Vec3};
/// use morph_collision::motion::{MotionQuery, MovingBody};
/// use morph_collision::{Body, BuildOptions, MorphBvh, MorphModel, Pose, WorldFromModel};
///
/// // A triangle, and a target that lifts it to z = 2.
/// let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z * 2.0; 3]])?;
/// let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let (mut rest, mut lifted) = (Pose::new(bvh.clone()), Pose::new(bvh.clone()));
/// lifted.set_weights(&[1.0])?;
/// // Another one rests at z = 1, turned over the first one's corner.
/// let (mut before, mut after) = (Pose::new(bvh.clone()), Pose::new(bvh));
/// let place = |translation: Vec3| WorldFromModel::new(Affine3A::from_translation(translation));
/// let (origin, above) = (place(Vec3::ZERO)?, place(Vec3::new(0.25, 0.25, 1.0))?);
///
/// let rising = MovingBody::new(Body::new(&mut rest, &origin), Body::new(&mut lifted, &origin))?;
/// let resting = MovingBody::new(Body::new(&mut before, &above), Body::new(&mut after, &above))?;
/// let first = MotionQuery::new().first(rising, resting, 1e-6).ok_or("no contact")?;
/// assert!(first.time.earliest <= 0.5 && first.time.latest >= 0.5);
/// assert_eq!((first.normal, first.velocity), (DVec3::NEG_Z, DVec3::Z * 2.0)); // it comes from below
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct MotionQuery {
    walk: OverlapWalk,
    stack: SelfStack,
    boxes: [MovingBoxes; 2],
    leaves: [MovingLeaves; 2],
    at_start: PairQuery,
    /// Made when the first ball is asked about.
    ball: Option<Box<BallBox>>,
    stats: QueryStats,
}

query_basics!(MotionQuery, |query| query.stats);

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
            Order::Any,
            &mut |candidate, stats| match candidate.impact(tolerance, stats) {
                Some(contact) => visitor(contact),
                None => ControlFlow::Continue(()),
            },
        );
    }

    /// Returns the first contact, if there is one.
    ///
    /// Bodies that intersect when the motion starts are in contact then ([`AtStart`](super::Features::AtStart)); which pair of triangles
    /// is returned depends on the tree. Otherwise the answer does not: if several contacts have the same time, the smallest
    /// [`Features`](super::Features) win. Nothing touches before `time.earliest`.
    ///
    /// Cost: nodes are visited in the order of the times at which their boxes overlap, up to the time of the first contact.
    pub fn first(&mut self, mut a: MovingBody<'_>, mut b: MovingBody<'_>, tolerance: f64) -> Option<MotionContact> {
        if let Some(early) = self.before_walk(&mut a, &mut b) {
            return early.map(|pair| MotionContact::at_start(pair, &mut a, &mut b));
        }
        let work = self.stats;
        let mut first: Option<MotionContact> = None;
        let latest = Cell::new(1.0);
        self.run(a, b, Order::EarliestFirst(&latest), &mut |candidate, stats| {
            if let Some(contact) = candidate.impact(tolerance, stats) {
                let earlier = earlier(first, contact);
                first = Some(earlier);
                latest.set(earlier.time.latest);
            }
            ControlFlow::Continue(())
        });
        self.stats += work;
        first
    }

    /// Returns whether the bodies touch at any time, including at the start. If not, that is a proof.
    pub fn any(&mut self, mut a: MovingBody<'_>, mut b: MovingBody<'_>) -> bool {
        if let Some(early) = self.before_walk(&mut a, &mut b) {
            return early.is_some();
        }
        let work = self.stats;
        let mut any = false;
        self.run(a, b, Order::DeepestFirst, &mut |candidate, stats| {
            any = candidate.touches(stats);
            if any {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        self.stats += work;
        any
    }

    /// Returns where a moving ball, or point, first touches a moving body, if it does. If several triangles are touched in the same interval
    /// of time, the one with the smallest number is returned.
    ///
    /// For a point, the answer is exact, like that for a vertex. For a ball, nothing is missed, and it does not touch before
    /// `time.earliest`. It may count as touching although it passes by so closely that this is unclear when the time has been halved to
    /// intervals as short as the tolerance (or `2^-40`), or closer than 2e-14 of the largest distance between its center and the triangle.
    ///
    /// Cost: as for [`MotionQuery::first`].
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Vec3};
    /// use morph_collision::motion::{MotionQuery, MovingBall, MovingBody, MovingPoint};
    /// # use morph_collision::{Body, BuildOptions, MorphBvh, MorphModel, Pose, WorldFromModel};
    ///
    /// // A triangle, and a target that lifts it to z = 2.
    /// let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z * 2.0; 3]])?;
    /// let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
    /// let (mut rest, mut lifted, world) = (Pose::new(bvh.clone()), Pose::new(bvh), WorldFromModel::IDENTITY);
    /// lifted.set_weights(&[1.0])?;
    /// let rising = MovingBody::new(Body::new(&mut rest, &world), Body::new(&mut lifted, &world))?;
    ///
    /// // A ball falls towards it.
    /// let fall = MovingPoint::new(DVec3::new(0.25, 0.25, 4.5), DVec3::new(0.25, 0.25, 2.5));
    /// let impact = MotionQuery::new().first_of_ball(&MovingBall::new(fall, 0.5)?, rising, 1e-6).ok_or("no impact")?;
    /// assert!(impact.time.earliest <= 1.0 && impact.time.latest == 1.0);
    /// assert_eq!((impact.normal, impact.velocity), (DVec3::Z, DVec3::Z * -4.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn first_of_ball(&mut self, ball: &MovingBall, mut body: MovingBody<'_>, tolerance: f64) -> Option<BallImpact> {
        let mut bounds = self.ball.take().unwrap_or_else(|| Box::new(BallBox::new()));
        let bvh = body.bvh();
        let (mut first, latest) = (None, Cell::new(1.0));
        let mut test = |triangle: &MovingTriangle<'_>, stats: &mut QueryStats| {
            let impact = if ball.radius() > 0.0 {
                stats.feature_tests += 1;
                ball.impact(triangle, tolerance, latest.get())
            } else {
                let features = Features::FaceVertex {
                    triangle_a: triangle.number,
                    vertex_b: 0,
                };
                let candidate = Candidate::vertex_face(features, ball.center(), [triangle; 2]);
                let contact = candidate.impact(tolerance, stats);
                contact.map(|contact| BallImpact::of_point(triangle.number, &contact))
            };
            if let Some(impact) = impact {
                let earlier = BallImpact::earlier(first, impact);
                first = Some(earlier);
                latest.set(earlier.time.latest);
            }
        };
        self.walk(
            body.reborrow(),
            bounds.around(ball),
            Order::EarliestFirst(&latest),
            &mut |(a, leaves_a), of_b, leaves, stats| {
                triangles_at_box((a, leaves_a, bvh.owners()), of_b, leaves, (&latest, stats), &mut test);
                ControlFlow::Continue(())
            },
        );
        self.ball = Some(bounds);
        first
    }

    /// Appends every pair of features of one body that touch, leaving out those that share a vertex. So a fold at a common edge is not
    /// listed, and, as for [`MotionQuery::all`], neither are parts that already cross each other ([`SelfQuery`](crate::SelfQuery)).
    ///
    /// Contacts of a vertex and a face are [`VertexFace`](super::Features::VertexFace); of two edges, the smaller one is first.
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
        let mut body = Moving::new(ends, drift, boxes, true);
        leaves.begin(Observer::new(middle, drift, body.standing().size));
        let mut test = |candidate: &Candidate<'_>, stats: &mut QueryStats| match candidate.impact(tolerance, stats) {
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

    /// The answer, if it takes no walk over both motions: no contact if the bounds of the motions are apart, or the triangles that intersect
    /// at the start.
    fn before_walk(&mut self, a: &mut MovingBody<'_>, b: &mut MovingBody<'_>) -> Option<Option<TrianglePair>> {
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
        let moving_a = Moving::new(ends_a, drift, boxes_a, false);
        let moving_b = Moving::new(ends_b, drift, boxes_b, false);
        let placements = Placements {
            a: moving_a.standing(),
            b: moving_b.standing(),
        };
        if !placements.begin_walk(walk) {
            return Some(None);
        }
        let pair = self.at_start.first(a.start.reborrow(), b.start.reborrow());
        self.stats += self.at_start.stats();
        pair.map(Some)
    }

    /// Calls `test` for features that may touch, until it breaks.
    fn run(&mut self, a: MovingBody<'_>, b: MovingBody<'_>, order: Order<'_>, test: &mut Test<'_>) {
        let always = Cell::new(1.0);
        let latest = match order {
            Order::EarliestFirst(latest) => latest,
            _ => &always,
        };
        let (bvh_a, bvh_b) = (a.bvh(), b.bvh());
        self.walk(a, b, order, &mut |(a, leaves_a), (b, leaves_b), leaves, stats| {
            let of_a = (a, leaves_a, bvh_a.owners());
            let of_b = (b, leaves_b, bvh_b.owners());
            candidates(of_a, of_b, leaves, (latest, stats), test)
        });
    }

    /// Calls `at_leaves` for pairs of leaves that may touch, until it breaks.
    fn walk(
        &mut self,
        mut a: MovingBody<'_>,
        mut b: MovingBody<'_>,
        order: Order<'_>,
        at_leaves: &mut AtMovingLeaves<'_>,
    ) {
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
        let mut a = Moving::new(ends_a, drift, boxes_a, false);
        let mut b = Moving::new(ends_b, drift, boxes_b, false);
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
                at_leaves((a, &mut *leaves_a), (b, &mut *leaves_b), leaves, stats)
            });
            stats.node_tests = walk.node_tests - tests_before;
        } else {
            stats.node_tests = 1;
        }
        let after = [&a.ends[0], &a.ends[1], &b.ends[0], &b.ends[1]].map(Posed::blended);
        *stats += QueryStats::blending(before, after);
    }
}

/// A body and its leaves.
type Leaves<'l, 'm, 'p> = (&'l mut Moving<'m, 'p>, &'l mut MovingLeaves);

/// The callback for pairs of leaves of two bodies.
type AtMovingLeaves<'v> =
    dyn FnMut(Leaves<'_, '_, '_>, Leaves<'_, '_, '_>, &[(Leaf, Leaf)], &mut QueryStats) -> ControlFlow<()> + 'v;

/// The middle of the first body when the motion starts, and how far it moves. Queries take that motion off both bodies.
fn drift(ends: &mut [Posed<'_>; 2]) -> (DVec3, DVec3) {
    let [from, to] = ends.each_mut().map(|end| middle(end.stand()));
    (from, to - from)
}

/// The earlier one of two contacts. Among equals, the features decide, so that the answer depends on no tree.
fn earlier(first: Option<MotionContact>, contact: MotionContact) -> MotionContact {
    let key = |contact: &MotionContact| (contact.time.latest, contact.time.earliest, contact.features);
    match first {
        Some(first) if key(&first) <= key(&contact) => first,
        _ => contact,
    }
}
