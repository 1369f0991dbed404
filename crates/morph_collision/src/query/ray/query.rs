//! The query for what a ray hits.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use fearless_simd::Simd;
use glam::DVec3;

use super::projection::RayProjection;
use crate::bounds::{BoxLanes, Keys, LANES, LocalRay, LowerBounds, PlacedBounds, RayCull};
use crate::exact::{Crossing, Line, Triangle, closest_on_triangle, ray_meets_triangle};
use crate::input_error::InputError;
use crate::query::anchor::SurfaceAnchor;
use crate::query::batch::OneBodyBatch;
use crate::query::body::Body;
use crate::query::input::Ray;
use crate::query::one_body::OneBody;
use crate::query::rank::Rank;
use crate::tree::CornerLanes;

/// The side of a triangle that a ray hits. From the front, the corners appear counter-clockwise in world space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Facing {
    /// The ray goes against the normal.
    Front,
    /// The ray goes with the normal.
    Back,
    /// The ray lies in the triangle's plane, or the triangle has no normal.
    EdgeOn,
}

/// Relative to the first hit's parameter: other hits matter up to there. It covers the rounding of parameters. It is larger than that, so
/// that for hits at the same point, no exact arithmetic is needed to find that they matter.
const MARGIN: f64 = 1e-12;

/// The first point that a ray and a triangle share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// The triangle's index in its mesh.
    pub triangle: u32,
    /// The barycentric coordinates of [`RayHit::point`]: not negative, with sum 1.
    pub barycentrics: [f64; 3],
    /// The ray's parameter at the hit: the exact one, rounded to the nearest `f64`. So triangles that the ray hits at the same point have
    /// the same `t`, on all bodies.
    pub t: f64,
    /// The distance from the ray's origin, in world units.
    pub distance: f64,
    /// The point on the triangle, in world space.
    pub point: DVec3,
    /// The triangle's unit normal, from its winding in world space; zero for a triangle without area.
    pub normal: DVec3,
    /// The side that was hit.
    pub facing: Facing,
}

/// Casts rays at a body. Keep the query and use it again: it reuses its memory.
///
/// A ray hits every triangle it shares a point with. That includes rays that touch an edge or a corner or lie in the triangle's plane,
/// and triangles degenerated to segments or points. Whether a triangle is hit, and from which side, is exact for the posed vertices in
/// world space, also at the ray's ends. No ray slips through a shared edge. No answer depends on the tree.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{DVec3, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// # let world_from_model = WorldFromModel::IDENTITY;
/// pose.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
/// let down = Ray::new(DVec3::new(0.25, 0.25, 2.0), DVec3::NEG_Z, f64::INFINITY)?;
/// let hit = RayQuery::new().closest(Body::new(&mut pose, &world_from_model), &down);
/// let hit = hit.ok_or("nothing hit")?;
/// assert_eq!((hit.triangle, hit.t, hit.facing), (0, 1.5, Facing::Front));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct RayQuery {
    pub(super) one: OneBody,
    /// Scratch memory: hits to sort.
    ranked: Vec<(Rank<u32>, RayHit)>,
    pub(super) batch: OneBodyBatch<Self>,
}

query_basics!(RayQuery, |query| query.one.stats);

impl RayQuery {
    /// Returns the hit with the smallest `t`; among equals, the one with the lowest triangle index (see [`Rank`]). It is the first hit of
    /// [`RayQuery::all`].
    pub fn closest(&mut self, body: Body<'_>, ray: &Ray) -> Option<RayHit> {
        let first = self.first(body, ray, |number, crossing, triangle| {
            Some((number, *crossing, *triangle))
        });
        first.map(|(number, crossing, triangle)| RayHit::new(ray, number, &crossing, &triangle))
    }

    /// Like [`RayQuery::closest`], but ignores hits that `accept` rejects, for example back faces or certain triangles.
    ///
    /// `accept` is also called with some hits that turn out not to be the closest.
    pub fn closest_where(
        &mut self,
        body: Body<'_>,
        ray: &Ray,
        mut accept: impl FnMut(&RayHit) -> bool,
    ) -> Option<RayHit> {
        self.first(body, ray, |number, crossing, triangle| {
            Some(RayHit::new(ray, number, crossing, triangle)).filter(&mut accept)
        })
    }

    /// What `accept` makes of the first hit that it accepts. It is called for hits that come before all those accepted so far.
    fn first<T>(
        &mut self,
        body: Body<'_>,
        ray: &Ray,
        mut accept: impl FnMut(u32, &Crossing, &Triangle) -> Option<T>,
    ) -> Option<T> {
        let mut first: Option<(Rank<u32>, T)> = None;
        let _never_stopped = self.cast(body, ray, |number, crossing, triangle| {
            // The `t` of a `RayHit` may be out of range, in units of a very long or short direction. This one is not.
            let rank = Rank::new(crossing.t, number);
            if first.as_ref().is_none_or(|(first, _)| rank < *first)
                && let Some(accepted) = accept(number, crossing, triangle)
            {
                first = Some((rank, accepted));
            }
            let limit = |(rank, _): &(Rank<u32>, T)| rank.distance * (1.0 + MARGIN);
            ControlFlow::Continue(first.as_ref().map_or(f64::INFINITY, limit))
        });
        first.map(|(_, accepted)| accepted)
    }

    /// Returns whether the ray hits anything.
    pub fn any(&mut self, body: Body<'_>, ray: &Ray) -> bool {
        self.cast(body, ray, |_, _, _| ControlFlow::Break(())).is_break()
    }

    /// Appends every hit, one per triangle, sorted by `t` and then by triangle (see [`Rank`]).
    pub fn all(&mut self, body: Body<'_>, ray: &Ray, hits: &mut Vec<RayHit>) {
        let mut ranked = std::mem::take(&mut self.ranked);
        let _finished = self.cast(body, ray, |number, crossing, triangle| {
            let hit = RayHit::new(ray, number, crossing, triangle);
            ranked.push((Rank::new(crossing.t, number), hit));
            ControlFlow::Continue(f64::INFINITY)
        });
        ranked.sort_unstable_by_key(|(rank, _)| *rank);
        hits.extend(ranked.drain(..).map(|(_, hit)| hit));
        self.ranked = ranked;
    }

    /// Returns whether a point is inside a closed mesh or on its surface. The triangles may all face outwards or all inwards.
    ///
    /// Casts a ray from the point and counts how often it passes through front and back faces; outside, the counts are equal. If the ray
    /// meets an edge, the count is uncertain, so another ray is cast. A mesh with holes has no inside: near a hole, either answer is
    /// possible.
    ///
    /// # Errors
    /// [`InputError`] if the point is not finite or beyond 1e50.
    pub fn encloses(&mut self, mut body: Body<'_>, point: DVec3) -> Result<bool, InputError> {
        /// Directions that are unlikely to be aligned with a model's edges or faces.
        const DIRECTIONS: [DVec3; 5] = [
            DVec3::new(0.7391, 0.4127, 0.5323),
            DVec3::new(-0.3271, 0.8117, 0.4831),
            DVec3::new(0.5417, -0.6173, 0.5711),
            DVec3::new(-0.6029, -0.4783, -0.6389),
            DVec3::new(0.2087, 0.3313, -0.9203),
        ];
        /// Hits that are closer together than this, relative to `t`, may be a single passage through an edge.
        const TOGETHER: f64 = 1e-9;
        let (mut inside, mut outside) = (0, 0);
        for direction in DIRECTIONS {
            let ray = Ray::new(point, direction, f64::INFINITY)?;
            let mut hits = Vec::new();
            self.all(body.reborrow(), &ray, &mut hits);
            if hits.first().is_some_and(|hit| hit.t == 0.0) {
                return Ok(true);
            }
            let winding: i64 = hits
                .iter()
                .map(|hit| match hit.facing {
                    Facing::Front => -1,
                    Facing::Back => 1,
                    Facing::EdgeOn => 0,
                })
                .sum();
            let is_clear = hits.iter().all(|hit| hit.facing != Facing::EdgeOn)
                && hits.windows(2).all(|pair| pair[1].t - pair[0].t > TOGETHER * pair[1].t);
            if is_clear {
                return Ok(winding != 0);
            }
            *(if winding == 0 { &mut outside } else { &mut inside }) += 1;
        }
        Ok(inside > outside)
    }

    /// Calls `at_hit` for hits until it breaks. `at_hit` returns the line's parameter beyond which hits no longer matter.
    fn cast(
        &mut self,
        mut body: Body<'_>,
        ray: &Ray,
        mut at_hit: impl FnMut(u32, &Crossing, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let line = &ray.line;
        let (bounds, level) = {
            let tree = &mut body.posed();
            let (corner_error, level, placed) = (tree.corner_error(), tree.level, &tree.placed_body().placed);
            (RayBounds::new(line, placed, corner_error), level)
        };
        // The part of the ray on which hits still matter.
        let mut near = *line;
        self.one.walk(body, line.max_t, &bounds, &mut |number, triangle| {
            if let Some(crossing) = ray_meets_triangle(level, &near, triangle) {
                near.max_t = at_hit(number, &crossing, triangle)?.min(line.max_t);
            }
            ControlFlow::Continue(near.max_t)
        })
    }
}

/// What boxes and triangles are tested with before exact tests.
struct RayBounds {
    cull: RayCull,
    projection: RayProjection,
}

impl RayBounds {
    fn new(line: &Line, body: &PlacedBounds, corner_error: f32) -> Self {
        let local = LocalRay::new(line.origin, line.direction, body);
        let local = local.as_ref();
        Self {
            cull: RayCull::new(local, body),
            projection: RayProjection::new(local, corner_error),
        }
    }
}

impl LowerBounds for RayBounds {
    fn key(&self, limit: f64) -> f32 {
        self.cull.key(limit)
    }

    #[inline(always)]
    fn lower_bounds<S: Simd>(&self, simd: S, boxes: &BoxLanes, lanes: u8, limit: f32, keys: &mut Keys) -> u8 {
        self.cull.lower_bounds(simd, boxes, lanes, limit, keys)
    }

    #[inline(always)]
    fn triangles<S: Simd>(&self, simd: S, corners: &CornerLanes, _limit: f32, keys: &mut Keys) -> u8 {
        *keys = [f32::NEG_INFINITY; LANES];
        self.projection.candidates(simd, corners)
    }
}

impl RayHit {
    fn new(ray: &Ray, number: u32, crossing: &Crossing, triangle: &Triangle) -> Self {
        let Ray { line, scale } = ray;
        let [a, b, c] = *triangle;
        let foot = closest_on_triangle(line.origin + line.direction * crossing.t, triangle);
        Self {
            triangle: number,
            barycentrics: foot.barycentrics,
            t: crossing.t / scale,
            distance: crossing.t * line.direction.length(),
            point: foot.point,
            normal: (b - a).cross(c - a).normalize_or_zero(),
            facing: match crossing.along_normal {
                Ordering::Less => Facing::Front,
                Ordering::Greater => Facing::Back,
                Ordering::Equal => Facing::EdgeOn,
            },
        }
    }
}

impl From<&RayHit> for SurfaceAnchor {
    fn from(hit: &RayHit) -> Self {
        Self {
            triangle: hit.triangle,
            barycentrics: hit.barycentrics,
        }
    }
}
