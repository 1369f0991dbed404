use std::ops::ControlFlow;

use super::body::Body;
use super::input::{Ball, ConvexRegion};
use super::one::{OneBody, magnitude};
use super::stats::QueryStats;
use crate::bounds::{Box64, ModelPlane};
use crate::exact::triangle_meets_region;

/// Asks which triangles of a body share a point with a part of space; holds the memory that queries reuse.
///
/// With a [`ConvexRegion`] (a box, a frustum) the answer is exact over the posed vertices in world space; touching
/// counts. With a [`Ball`] it is as exact as the distance, see [`ClosestPoint`](crate::ClosestPoint). What counts is the surface: a
/// region wholly inside a closed mesh meets no triangle.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{DVec3, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// # let place = WorldFromModel::IDENTITY;
/// let upper = ConvexRegion::from_half_spaces(&[HalfSpace::new(DVec3::Z, -0.5)?]); // z >= 0.5
/// let mut query = OverlapQuery::new();
/// assert!(!query.meets_region(Body::new(&mut pose, &place), &upper).0);
/// pose.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
/// assert!(query.meets_region(Body::new(&mut pose, &place), &upper).0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct OverlapQuery {
    one: OneBody,
}

impl OverlapQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether any triangle shares a point with a region.
    pub fn meets_region(&mut self, body: Body<'_>, region: &ConvexRegion) -> (bool, QueryStats) {
        let mut meets = false;
        let stats = self.region(body, region, |_| {
            meets = true;
            ControlFlow::Break(())
        });
        (meets, stats)
    }

    /// Appends the triangles that share a point with a region, ascending.
    pub fn triangles_in_region(
        &mut self,
        body: Body<'_>,
        region: &ConvexRegion,
        triangles: &mut Vec<u32>,
    ) -> QueryStats {
        let start = triangles.len();
        let stats = self.region(body, region, |number| {
            triangles.push(number);
            ControlFlow::Continue(())
        });
        triangles[start..].sort_unstable();
        stats
    }

    /// Whether any triangle is within a ball.
    pub fn meets_ball(&mut self, body: Body<'_>, ball: &Ball) -> (bool, QueryStats) {
        let mut meets = false;
        let stats = self.one.near(body, ball, |_, _| {
            meets = true;
            ControlFlow::Break(())
        });
        (meets, stats)
    }

    /// Appends the triangles at most the radius away from a ball's centre, ascending.
    pub fn triangles_in_ball(&mut self, body: Body<'_>, ball: &Ball, triangles: &mut Vec<u32>) -> QueryStats {
        let start = triangles.len();
        let stats = self.one.near(body, ball, |number, _| {
            triangles.push(number);
            ControlFlow::Continue(f64::INFINITY)
        });
        triangles[start..].sort_unstable();
        stats
    }

    fn region(
        &mut self,
        body: Body<'_>,
        region: &ConvexRegion,
        mut visitor: impl FnMut(u32) -> ControlFlow<()>,
    ) -> QueryStats {
        let mut tree = body.pose.posed();
        let magnitude = magnitude(&mut tree);
        let planes: Vec<_> = region
            .planes
            .iter()
            .map(|plane| ModelPlane::new(plane.normal, plane.offset, body.world_from_model, magnitude))
            .collect();
        let reached = |bounds: &Box64| planes.iter().all(|plane| plane.reaches(bounds)).then_some(0.0);
        self.one
            .walk(&mut tree, body.world_from_model, 0.0, reached, |number, triangle| {
                if triangle_meets_region(triangle, &region.planes) {
                    visitor(number)?;
                }
                ControlFlow::Continue(0.0)
            })
    }
}
