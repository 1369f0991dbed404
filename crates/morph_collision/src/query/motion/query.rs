//! The query for contacts during a motion.

use std::cell::Cell;
use std::ops::ControlFlow;

use super::ball::impact_of_point;
use super::candidate::{Candidate, Test, between, within};
use super::earliest::Earliest;
use super::limit::{DEFAULT_LIMIT, steps};
use super::shape_box::ShapeBox;
use super::triangle::MovingTriangle;
use super::walk::{MotionWalk, Search};
use super::{Features, LimitReached, MotionContact, MovingBall, MovingBody, MovingShape, SurfaceImpact};
use crate::query::capped::Capped;
use crate::query::shape::first_touch_of_triangle;
use crate::query::{PairQuery, QueryStats, TrianglePair};

/// Finds contacts that happen while two bodies move, or while one body deforms. Keep the query and use it again: it reuses its memory.
///
/// See the [module](crate::motion) for what moves how. Answers are exact, but for those about balls, and touching counts, at the start and
/// at the end of the motion, too. A contact that lasts has the time at which it begins.
///
/// Times are shares of the motion, from 0 to 1. `tolerance` is the largest difference between the two ends of a time
/// ([`TimeOfImpact`](super::TimeOfImpact)), unless these are neighbouring `f64`s. Usually the ends differ by at most `2^-30`, however large
/// the tolerance is. A smaller tolerance changes how precisely you learn when something touches, never whether it does. Below about 1e-12,
/// every contact takes exact arithmetic. A negative tolerance or NaN counts as 0.
///
/// Cost: like a [`PairQuery`] in which each node has the size of the space that it sweeps through, and pairs of nodes that are never at the
/// same place at the same time are left out. A translation that both bodies share does not count. If bodies are as small as the rounding
/// errors of their positions at the start or at the end, a search for one contact places all their triangles and compares them by boxes in
/// `f64`. The work of a call is limited ([`MotionQuery::with_limit`]).
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
/// let first = MotionQuery::new().first(rising, resting, 1e-6)?.ok_or("no contact")?;
/// assert!(first.time.earliest <= 0.5 && first.time.latest >= 0.5);
/// assert_eq!((first.normal, first.velocity), (DVec3::NEG_Z, DVec3::Z * 2.0)); // it comes from below
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct MotionQuery {
    walk: MotionWalk,
    at_start: PairQuery,
    /// Made when the first ball or shape is asked about.
    shape_box: Option<Box<ShapeBox>>,
    limit: u64,
    stats: QueryStats,
}

impl Default for MotionQuery {
    fn default() -> Self {
        Self {
            walk: MotionWalk::default(),
            at_start: PairQuery::new(),
            shape_box: None,
            limit: DEFAULT_LIMIT,
            stats: QueryStats::default(),
        }
    }
}

query_basics!(MotionQuery, |query| query.stats);

impl MotionQuery {
    /// Limits the work of every call to about this many steps, which take a few nanoseconds each. By default, calls end after minutes.
    ///
    /// A step is the test of two boxes. A pair of features that the `f64` filter decides counts as 64 steps, one that is decided by exact
    /// signs at the start or at the end as 500, and one that takes exact polynomials as 200 for each bit of its coordinates, more than
    /// 10,000. Each interval of time that is looked at for a ball counts as 64. If all triangles of collapsed bodies are compared, each
    /// takes 64. Tests of nodes and all other work have the limit separately, so a call may take twice as many steps.
    ///
    /// The search for triangles that intersect when the motion starts is not limited.
    #[must_use]
    pub fn with_limit(mut self, steps: u64) -> Self {
        self.set_limit(steps);
        self
    }

    /// Changes the limit ([`MotionQuery::with_limit`]).
    pub fn set_limit(&mut self, steps: u64) {
        self.limit = steps;
    }

    /// The work of the last call, in the steps of [`MotionQuery::with_limit`].
    #[must_use]
    pub fn steps(&self) -> u64 {
        steps(&self.stats) + self.walk.placing()
    }

    /// Appends every pair of features that touch, in the order of the walk. Each pair is listed once.
    ///
    /// Triangles that already cross each other when the motion starts are listed only if their features touch as well; use
    /// [`PairQuery`] for those.
    ///
    /// # Errors
    /// [`LimitReached`] if there may be more.
    pub fn all(
        &mut self,
        a: MovingBody<'_>,
        b: MovingBody<'_>,
        tolerance: f64,
        contacts: &mut Vec<MotionContact>,
    ) -> Result<(), LimitReached> {
        self.visit(a, b, tolerance, |contact| {
            contacts.push(contact);
            ControlFlow::Continue(())
        })
    }

    /// Appends the first `limit` contacts of [`MotionQuery::all`]; returns whether there are more.
    ///
    /// # Errors
    /// [`LimitReached`] if there may be more, unless more than `limit` were found.
    pub fn up_to(
        &mut self,
        a: MovingBody<'_>,
        b: MovingBody<'_>,
        tolerance: f64,
        limit: usize,
        contacts: &mut Vec<MotionContact>,
    ) -> Result<bool, LimitReached> {
        let mut listed = Capped::new(contacts, limit);
        self.visit(a, b, tolerance, |contact| listed.push(contact))?;
        Ok(listed.is_truncated)
    }

    /// Calls `visitor` for every pair of features that touch, until it breaks.
    ///
    /// # Errors
    /// [`LimitReached`] if there may be more.
    pub fn visit(
        &mut self,
        a: MovingBody<'_>,
        b: MovingBody<'_>,
        tolerance: f64,
        mut visitor: impl FnMut(MotionContact) -> ControlFlow<()>,
    ) -> Result<(), LimitReached> {
        self.features(
            a,
            b,
            Search::All,
            &mut |candidate, stats| match candidate.impact(tolerance, stats) {
                Some(contact) => visitor(contact),
                None => ControlFlow::Continue(()),
            },
        )
    }

    /// Returns the first contact, if there is one.
    ///
    /// Nothing touches before `time.earliest`, and these features touch at `time.latest` or before. If several contacts have the same time,
    /// the smallest [`Features`] win; but if bodies are as small as rounding errors, of triangles that move alike only the one with the
    /// smallest number is compared. If telling which of very many contacts is the first takes too much work, the answer is one that begins
    /// at most the tolerance after the first one; which one depends on the tree.
    ///
    /// Bodies that intersect when the motion starts are in contact then ([`AtStart`](super::Features::AtStart)).
    ///
    /// Cost: nodes are visited in the order of the times at which their boxes overlap, up to the time of the first contact.
    ///
    /// # Errors
    /// [`LimitReached`] if the limit was reached before any contact was found. If it was reached later, the contact is returned with an
    /// earlier `time.earliest`, before which nothing touches.
    pub fn first(
        &mut self,
        mut a: MovingBody<'_>,
        mut b: MovingBody<'_>,
        tolerance: f64,
    ) -> Result<Option<MotionContact>, LimitReached> {
        if let Some(early) = self.before_walk(&mut a, &mut b) {
            return Ok(early.map(|pair| MotionContact::at_start(pair, &mut a, &mut b)));
        }
        let work = self.stats;
        let mut earliest = Earliest::new(tolerance);
        let latest = Cell::new(1.0);
        let walked = self.features(a, b, Search::First(&latest), &mut |candidate, stats| {
            let features = |contact: &MotionContact| (contact.features, contact.triangles);
            if let Some(contact) = candidate.impact(tolerance, stats)
                && earliest.add(contact.time, contact, features, stats)
            {
                // Where an edge ends, the normal of its vertex and the face says more than that of two edges.
                for corner in candidate.corners() {
                    if let Some(contact) = corner.impact(tolerance, stats) {
                        earliest.add(contact.time, contact, features, stats);
                    }
                }
            }
            latest.set(earliest.latest(stats));
            ControlFlow::Continue(())
        });
        self.stats += work;
        let first = earliest.found(walked)?;
        Ok(first.map(|(time, contact)| MotionContact { time, ..contact }))
    }

    /// Returns whether the bodies touch at any time, including at the start. If not, that is a proof.
    ///
    /// # Errors
    /// [`LimitReached`] if no contact was found, but there may be one.
    pub fn any(&mut self, mut a: MovingBody<'_>, mut b: MovingBody<'_>) -> Result<bool, LimitReached> {
        if let Some(early) = self.before_walk(&mut a, &mut b) {
            return Ok(early.is_some());
        }
        let work = self.stats;
        let mut any = false;
        let walked = self.features(a, b, Search::Any, &mut |candidate, stats| {
            any = candidate.touches(stats);
            if any {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        self.stats += work;
        if any { Ok(true) } else { walked.map(|()| false) }
    }

    /// Returns where a moving ball, or point, first touches a moving body, if it does. If several triangles are touched in the same interval
    /// of time, the one with the smallest number is returned.
    ///
    /// For a point, the answer is exact, like that for a vertex. For a ball, nothing is missed, and it does not touch before
    /// `time.earliest`. It may count as touching although it passes by so closely that this is unclear
    ///
    /// - when the time has been halved to intervals as short as the tolerance (or `2^-40`),
    /// - after 65,536 intervals for one triangle, as with a gap of a millionth of the triangle's size while it turns by 4 degrees. Then the
    ///   difference between the two ends of `time` may be much larger than the tolerance, or
    /// - because the gap is less than 2e-14 of the largest distance between the center and the triangle.
    ///
    /// Time, cost and errors are those of [`MotionQuery::first`].
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
    /// let impact = MotionQuery::new().first_of_ball(&MovingBall::new(fall, 0.5)?, rising, 1e-6)?.ok_or("no impact")?;
    /// assert!(impact.time.earliest <= 1.0 && impact.time.latest == 1.0);
    /// assert_eq!((impact.normal, impact.velocity), (DVec3::Z, DVec3::Z * -4.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn first_of_ball(
        &mut self,
        ball: &MovingBall,
        body: MovingBody<'_>,
        tolerance: f64,
    ) -> Result<Option<SurfaceImpact>, LimitReached> {
        self.first_of(
            body,
            |bounds| bounds.around_ball(ball),
            tolerance,
            |triangle, latest, stats| {
                if ball.radius() > 0.0 {
                    return ball.impact(triangle, tolerance, latest, &mut stats.feature_tests);
                }
                let features = Features::FaceVertex {
                    triangle_a: triangle.number,
                    vertex_b: 0,
                };
                let candidate = Candidate::vertex_face(features, ball.center(), [triangle; 2]);
                let contact = candidate.impact(tolerance, stats);
                contact.map(|contact| impact_of_point(triangle.number, &contact))
            },
        )
    }

    /// Returns where a moving shape first touches a moving body, if it does. If several triangles are touched in the same interval
    /// of time, the one with the smallest number is returned.
    ///
    /// Nothing is touched before `time.earliest`, up to a few `f64` roundings of the coordinates involved. A triangle counts as touched when the gap is below
    /// 1e-13 of the coordinates (1.5e-8 for cylinders, cones and convex hulls), or if after 4096 steps it is not clear whether it is, as with a shape that
    /// turns very close beside it; `time` is then a longer interval.
    ///
    /// Cost and errors are those of [`MotionQuery::first`]. For a ball, [`MotionQuery::first_of_ball`] is more exact.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Quat, Vec3};
    /// use morph_collision::motion::{MotionQuery, MovingBody, MovingShape};
    /// # use morph_collision::{Body, BuildOptions, MorphBvh, MorphModel, PlacedShape, Pose, Shape, WorldFromModel};
    ///
    /// // A triangle, and a target that lifts it to z = 2.
    /// let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z * 2.0; 3]])?;
    /// let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
    /// let (mut rest, mut lifted, world) = (Pose::new(bvh.clone()), Pose::new(bvh), WorldFromModel::IDENTITY);
    /// lifted.set_weights(&[1.0])?;
    /// let rising = MovingBody::new(Body::new(&mut rest, &world), Body::new(&mut lifted, &world))?;
    ///
    /// // A box falls through it.
    /// let cuboid = PlacedShape::new(Shape::Cuboid { half_extents: Vec3::splat(0.5) }, Quat::IDENTITY, Vec3::new(0.25, 0.25, 4.5))?;
    /// let falling = MovingShape::new(cuboid, DVec3::NEG_Z * 6.0)?;
    /// let impact = MotionQuery::new().first_of_shape(&falling, rising, 1e-6)?.ok_or("no impact")?;
    /// assert!((impact.time.latest - 0.5).abs() < 1e-6);
    /// assert_eq!((impact.normal, impact.velocity), (DVec3::Z, DVec3::Z * -8.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn first_of_shape(
        &mut self,
        shape: &MovingShape,
        body: MovingBody<'_>,
        tolerance: f64,
    ) -> Result<Option<SurfaceImpact>, LimitReached> {
        self.first_of(
            body,
            |bounds| bounds.around_shape(shape),
            tolerance,
            |triangle, latest, stats| {
                let touch =
                    first_touch_of_triangle(shape, &triangle.points, tolerance, latest, &mut stats.feature_tests)?;
                Some(SurfaceImpact::new(triangle.number, shape, &triangle.points, &touch))
            },
        )
    }

    /// The first impact of something in a box. `impact` says when it touches a triangle, unless that is only after the given time.
    fn first_of(
        &mut self,
        body: MovingBody<'_>,
        around: impl Fn(&mut ShapeBox) -> MovingBody<'_>,
        tolerance: f64,
        impact: impl Fn(&MovingTriangle<'_>, f64, &mut QueryStats) -> Option<SurfaceImpact>,
    ) -> Result<Option<SurfaceImpact>, LimitReached> {
        let mut bounds = self.shape_box.take().unwrap_or_else(|| Box::new(ShapeBox::new()));
        let mut earliest = Earliest::new(tolerance);
        let latest = Cell::new(1.0);
        let mut test = |triangle: &MovingTriangle<'_>, _: &MovingTriangle<'_>, stats: &mut QueryStats| {
            if let Some(impact) = impact(triangle, latest.get(), stats) {
                earliest.add(impact.time, impact, |impact| impact.triangle, stats);
            }
            latest.set(earliest.latest(stats));
            ControlFlow::Continue(())
        };
        let Self { walk, limit, stats, .. } = self;
        let walked = walk.run(
            body,
            around(&mut bounds),
            Search::First(&latest),
            *limit,
            stats,
            &mut test,
        );
        self.shape_box = Some(bounds);
        let first = earliest.found(walked)?;
        Ok(first.map(|(time, impact)| SurfaceImpact { time, ..impact }))
    }

    /// Appends every pair of features of one body that touch, leaving out those that share a vertex. So a fold at a common edge is not
    /// listed, and, as for [`MotionQuery::all`], neither are parts that already cross each other ([`SelfQuery`](crate::SelfQuery)).
    ///
    /// Contacts of a vertex and a face are [`VertexFace`](super::Features::VertexFace); of two edges, the smaller one is first.
    ///
    /// # Errors
    /// [`LimitReached`] if there may be more.
    pub fn all_within(
        &mut self,
        body: MovingBody<'_>,
        tolerance: f64,
        contacts: &mut Vec<MotionContact>,
    ) -> Result<(), LimitReached> {
        self.visit_within(body, tolerance, |contact| {
            contacts.push(contact);
            ControlFlow::Continue(())
        })
    }

    /// Calls `visitor` for the contacts of [`MotionQuery::all_within`], until it breaks.
    ///
    /// # Errors
    /// [`LimitReached`] if there may be more.
    pub fn visit_within(
        &mut self,
        body: MovingBody<'_>,
        tolerance: f64,
        mut visitor: impl FnMut(MotionContact) -> ControlFlow<()>,
    ) -> Result<(), LimitReached> {
        let mut test = |candidate: &Candidate<'_>, stats: &mut QueryStats| match candidate.impact(tolerance, stats) {
            Some(contact) => visitor(contact),
            None => ControlFlow::Continue(()),
        };
        let Self { walk, limit, stats, .. } = self;
        walk.run_within(body, *limit, stats, &mut |t, s, stats| within(t, s, stats, &mut test))
    }

    /// The answer, if it takes no walk over both motions: no contact if the bounds of the motions are apart, or the triangles that intersect
    /// at the start.
    fn before_walk(&mut self, a: &mut MovingBody<'_>, b: &mut MovingBody<'_>) -> Option<Option<TrianglePair>> {
        self.stats = QueryStats {
            node_tests: 1,
            ..QueryStats::default()
        };
        if !self.walk.bounds_overlap(a, b) {
            return Some(None);
        }
        let pair = self.at_start.first(a.start.reborrow(), b.start.reborrow());
        self.stats += self.at_start.stats();
        pair.map(Some)
    }

    /// Calls `test` for features that may touch, until it breaks.
    fn features(
        &mut self,
        a: MovingBody<'_>,
        b: MovingBody<'_>,
        search: Search<'_>,
        test: &mut Test<'_>,
    ) -> Result<(), LimitReached> {
        let Self { walk, limit, stats, .. } = self;
        walk.run(a, b, search, *limit, stats, &mut |t, s, stats| match search {
            Search::All => between(t, s, stats, test),
            Search::Any | Search::First(_) => between(&t.without_points(), &s.without_points(), stats, test),
        })
    }
}
