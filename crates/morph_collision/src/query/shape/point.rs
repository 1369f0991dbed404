//! The closest point on a body's surface.

use std::ops::ControlFlow;

use glam::DVec3;

use super::ShapeQuery;
use crate::bounds::{Box64, ByBox, GapFrame, PlacedBounds, WorldFromModel};
use crate::exact::{Triangle, TrianglePoint, closest_on_triangle_exactly, largest};
use crate::input_error::{InputError, check_length, check_point};
use crate::query::Body;
use crate::query::anchor::SurfaceAnchor;
use crate::query::batch::Latest;
use crate::query::rank::{MARGIN, Rank};

/// The point on a body's surface that is closest to a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// The triangle's index in its mesh.
    pub triangle: u32,
    /// The barycentric coordinates of [`ClosestPoint::point`]: not negative, with sum 1.
    pub barycentrics: [f64; 3],
    /// The closest point, in world space.
    pub point: DVec3,
    /// The distance, in world units. It is 0 if and only if the point is on the triangle. Otherwise its error is a few `f64` roundings of
    /// the triangle's size and the distance.
    pub distance: f64,
}

impl ShapeQuery {
    /// Returns the point on the surface that is closest to `point`; `None` if it is farther away than `max_distance`, which may be
    /// infinite.
    ///
    /// The surface is the union of the closed triangles, degenerate ones included. The mesh need not be closed; a point inside it
    /// has a positive distance. Among equally close triangles, the one with the lowest index wins (see [`Rank`]).
    ///
    /// # Errors
    /// [`InputError`] if the point is not finite or beyond 1e50, or if `max_distance` is negative or NaN.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Vec3};
    /// # use morph_collision::*;
    /// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
    /// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    /// # let world_from_model = WorldFromModel::IDENTITY;
    /// pose.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
    /// let body = Body::new(&mut pose, &world_from_model);
    /// let closest = ShapeQuery::new().closest_point(body, DVec3::new(-2.0, 0.0, 0.5), f64::INFINITY)?;
    /// let closest = closest.ok_or("nothing there")?;
    /// assert_eq!((closest.distance, closest.point), (2.0, DVec3::new(0.0, 0.0, 0.5)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_point(
        &mut self,
        body: Body<'_>,
        point: DVec3,
        max_distance: f64,
    ) -> Result<Option<ClosestPoint>, InputError> {
        check_point("point", point)?;
        check_length("max_distance", max_distance)?;
        Ok(self.closest_point_from(body, point, max_distance, &mut None))
    }

    /// The closest point, for valid input. Tests the latest triangle first, because its distance is a limit for all others.
    pub(super) fn closest_point_from(
        &mut self,
        mut body: Body<'_>,
        point: DVec3,
        max_distance: f64,
        latest: &mut Latest,
    ) -> Option<ClosestPoint> {
        let target = Box64::point(point);
        let world = PlacedBounds::new(&WorldFromModel::IDENTITY, point.abs());
        let frames = GapFrame::list(&body.posed().placed_body().placed, &world);
        let targets: Vec<_> = frames.iter().map(|frame| (frame, frame.image_of_b(&target))).collect();
        let squared_distance = |bounds: &Box64| {
            let squared = |(frame, target): &(&GapFrame, Box64)| frame.squared(&frame.image_of_a(bounds), target);
            Some(largest(targets.iter().map(squared)))
        };
        let mut closest: Option<(Rank<u32>, TrianglePoint)> = None;
        let farthest = max_distance * max_distance * MARGIN;
        let mut at_triangle = |number, triangle: &Triangle| {
            let foot = closest_on_triangle_exactly(point, triangle);
            let rank = Rank::new(foot.squared.sqrt(), number);
            if rank.distance <= max_distance && closest.as_ref().is_none_or(|(best, _)| rank < *best) {
                closest = Some((rank, foot));
            }
            let of_closest = |(_, foot): &(_, TrianglePoint)| farthest.min(foot.squared * MARGIN);
            closest.as_ref().map_or(farthest, of_closest)
        };
        let latest_triangle = latest.and_then(|number| Some((number, body.triangle(number)?)));
        let mut limit = latest_triangle.map_or(farthest, |(number, triangle)| at_triangle(number, &triangle));
        let _never_stopped = self
            .one
            .walk(body, limit, &ByBox(squared_distance), |number, triangle| {
                if !is_beyond(limit, point, triangle) {
                    limit = at_triangle(number, triangle);
                }
                ControlFlow::Continue(limit)
            });
        let (rank, foot) = closest?;
        *latest = Some(rank.id);
        Some(ClosestPoint {
            triangle: rank.id,
            barycentrics: foot.barycentrics,
            point: foot.point,
            distance: rank.distance,
        })
    }
}

/// Whether the squared distance of a triangle, as [`closest_on_triangle_exactly`] computes it, is certainly above a limit: that of the
/// triangle's bounding box is.
///
/// The error of a computed distance is a few roundings of the reach `r`, the largest distance to a corner. If the box is more than
/// `l + e r` away, the square of that is at most `(1 + k) l^2 + (1 + 1 / k) (e r)^2`, here with `k = 1e-3` and `e = 3e-14`.
fn is_beyond(limit: f64, point: DVec3, [a, b, c]: &Triangle) -> bool {
    let (below, above) = (a.min(*b).min(*c) - point, point - a.max(*b).max(*c));
    let gap = below.max(above).max(DVec3::ZERO);
    let reach = below.min(above);
    gap.length_squared() > 1.001 * limit + 1e-24 * reach.length_squared()
}

impl From<&ClosestPoint> for SurfaceAnchor {
    fn from(closest: &ClosestPoint) -> Self {
        Self {
            triangle: closest.triangle,
            barycentrics: closest.barycentrics,
        }
    }
}
