use std::cmp::Ordering;
use std::ops::ControlFlow;

use glam::DVec3;

use super::body::Body;
use super::input::Ray;
use super::one::{OneBody, magnitude};
use super::stats::QueryStats;
use crate::bounds::RayCull;
use crate::exact::{Crossing, Triangle, VALUE_ERROR, closest_on_triangle, ray_meets_triangle};

/// Which side of a triangle a ray sees: its front is where its corners go round counter-clockwise in world space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Facing {
    /// The ray goes against the normal.
    Front,
    /// The ray goes with the normal.
    Back,
    /// The ray goes within the triangle's plane, or the triangle has no normal.
    EdgeOn,
}

/// Where a ray meets a triangle first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// The triangle's number in its mesh.
    pub triangle: u32,
    /// The weights of the triangle's corners at [`RayHit::point`]; not negative, 1 in sum.
    pub barycentrics: [f64; 3],
    /// The ray's parameter, in lengths of its direction; to a relative error of 1e-11.
    pub t: f64,
    /// The distance from the ray's origin, in world units.
    pub distance: f64,
    /// The point on the triangle, in world space.
    pub point: DVec3,
    /// The triangle's unit normal in world space, by its winding there; zero where it has no area.
    pub normal: DVec3,
    /// Which side of the triangle the ray sees.
    pub facing: Facing,
}

/// Casts rays at a body; holds the memory that queries reuse.
///
/// A triangle is hit if it shares a point with the ray: touching an edge or a corner counts, and so do triangles in whose
/// plane the ray lies, and triangles that are only segments or points; such a hit is at the first shared point. Whether a
/// triangle is hit, and from which side, is exact over the posed vertices in world space, also at the ray's ends; so no ray
/// slips through an edge that triangles share. No answer depends on the tree.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{DVec3, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// # let place = WorldFromModel::IDENTITY;
/// pose.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
/// let down = Ray::new(DVec3::new(0.25, 0.25, 2.0), DVec3::NEG_Z, f64::INFINITY)?;
/// let (hit, _) = RayQuery::new().closest(Body::new(&mut pose, &place), &down);
/// let hit = hit.ok_or("nothing hit")?;
/// assert_eq!((hit.triangle, hit.t, hit.facing), (0, 1.5, Facing::Front));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct RayQuery {
    one: OneBody,
}

/// What to go on with after a triangle that is hit, given where and by what.
enum Next {
    /// Look at whatever the ray meets up to this parameter of the line.
    UpTo(f64),
    Stop,
}

impl RayQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The first hit along the ray; among hits with the same `t`, that of the lowest triangle.
    pub fn closest(&mut self, body: Body<'_>, ray: &Ray) -> (Option<RayHit>, QueryStats) {
        self.closest_where(body, ray, |_| true)
    }

    /// As [`RayQuery::closest`] among the hits that `accept` accepts: to see through back faces, or through chosen triangles.
    ///
    /// `accept` is asked about hits that turn out not to be the closest, too, and not about all.
    pub fn closest_where(
        &mut self,
        body: Body<'_>,
        ray: &Ray,
        mut accept: impl FnMut(&RayHit) -> bool,
    ) -> (Option<RayHit>, QueryStats) {
        let mut closest: Option<(f64, RayHit)> = None;
        let stats = self.cast(body, ray, |number, crossing, triangle| {
            let closer = match &closest {
                Some((t, hit)) => crossing.t < *t || (crossing.t == *t && number < hit.triangle),
                None => true,
            };
            if closer {
                let hit = RayHit::new(ray, number, crossing, triangle);
                if accept(&hit) {
                    closest = Some((crossing.t, hit));
                }
            }
            // Beyond the closest by more than `t` may be off nothing can be closer.
            let up_to = closest
                .as_ref()
                .map_or(f64::INFINITY, |(t, _)| t * (1.0 + 16.0 * VALUE_ERROR));
            Next::UpTo(up_to)
        });
        (closest.map(|(_, hit)| hit), stats)
    }

    /// Whether the ray hits anything.
    pub fn any(&mut self, body: Body<'_>, ray: &Ray) -> (bool, QueryStats) {
        let mut any = false;
        let stats = self.cast(body, ray, |_, _, _| {
            any = true;
            Next::Stop
        });
        (any, stats)
    }

    /// Appends all hits, by ascending `t` and then triangle: one for every triangle that the ray meets.
    pub fn all(&mut self, body: Body<'_>, ray: &Ray, hits: &mut Vec<RayHit>) -> QueryStats {
        let start = hits.len();
        let stats = self.visit(body, ray, |hit| {
            hits.push(hit);
            ControlFlow::Continue(())
        });
        hits[start..].sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        stats
    }

    /// Calls `visitor` for every hit, in the order of the walk, until it breaks.
    pub fn visit(
        &mut self,
        body: Body<'_>,
        ray: &Ray,
        mut visitor: impl FnMut(RayHit) -> ControlFlow<()>,
    ) -> QueryStats {
        self.cast(body, ray, |number, crossing, triangle| {
            match visitor(RayHit::new(ray, number, crossing, triangle)) {
                ControlFlow::Continue(()) => Next::UpTo(f64::INFINITY),
                ControlFlow::Break(()) => Next::Stop,
            }
        })
    }

    fn cast(
        &mut self,
        body: Body<'_>,
        ray: &Ray,
        mut at_hit: impl FnMut(u32, &Crossing, &Triangle) -> Next,
    ) -> QueryStats {
        let mut tree = body.pose.posed();
        let line = &ray.line;
        let cull = RayCull::new(line.origin, line.direction, body.world_from_model, magnitude(&mut tree));
        let mut limit = line.max_t;
        self.one.walk(
            &mut tree,
            body.world_from_model,
            limit,
            |bounds| cull.as_ref().map_or(Some(0.0), |cull| cull.enter(bounds)),
            |number, triangle| {
                if let Some(crossing) = ray_meets_triangle(line, triangle) {
                    match at_hit(number, &crossing, triangle) {
                        Next::UpTo(t) => limit = t.min(line.max_t),
                        Next::Stop => return ControlFlow::Break(()),
                    }
                }
                ControlFlow::Continue(limit)
            },
        )
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
