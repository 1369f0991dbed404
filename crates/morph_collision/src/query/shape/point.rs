//! The closest point on a body's surface.

use std::ops::ControlFlow;

use glam::DVec3;

use super::ShapeQuery;
use super::bound::distance_cull;
use crate::exact::{Triangle, TrianglePoint, closest_on_triangle_exactly};
use crate::input_error::{InputError, check_length, check_point};
use crate::query::Body;
use crate::query::anchor::SurfaceAnchor;
use crate::query::batch::Latest;
use crate::query::rank::Rank;

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
        let bounds = distance_cull(&mut body, [point; 2], 0.0);
        let mut closest: Option<(Rank<u32>, TrianglePoint)> = None;
        let mut at_triangle = |number, triangle: &Triangle| {
            let foot = closest_on_triangle_exactly(point, triangle);
            let rank = Rank::new(foot.squared.sqrt(), number);
            if rank.distance <= max_distance && closest.as_ref().is_none_or(|(best, _)| rank < *best) {
                closest = Some((rank, foot));
            }
            closest.as_ref().map_or(max_distance, |(best, _)| best.distance)
        };
        let latest_triangle = latest.and_then(|number| Some((number, body.triangle(number)?)));
        let limit = latest_triangle.map_or(max_distance, |(number, triangle)| at_triangle(number, &triangle));
        let _never_stopped = self.one.walk(body, limit, &bounds, &mut |number, triangle| {
            ControlFlow::Continue(at_triangle(number, triangle))
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

impl From<&ClosestPoint> for SurfaceAnchor {
    fn from(closest: &ClosestPoint) -> Self {
        Self {
            triangle: closest.triangle,
            barycentrics: closest.barycentrics,
        }
    }
}
