//! Triangles that intersect a convex region.

use std::ops::ControlFlow;

use super::ShapeQuery;
use crate::bounds::{Box64, ByBox, ModelPlane};
use crate::exact::{Plane, triangle_meets_region};
use crate::query::Body;
use crate::query::capped::Capped;
use crate::query::input::ConvexRegion;

impl ShapeQuery {
    /// Returns whether any triangle shares a point with a convex region, such as a box or a camera's frustum.
    ///
    /// Exact for the posed vertices in world space; touching counts. The body is a surface: a region wholly inside a closed mesh
    /// intersects no triangle.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Vec3};
    /// # use morph_collision::*;
    /// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
    /// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    /// # let world_from_model = WorldFromModel::IDENTITY;
    /// let upper = ConvexRegion::from_half_spaces(&[(DVec3::Z, -0.5)])?; // z >= 0.5
    /// let mut query = ShapeQuery::new();
    /// assert!(!query.any_in_region(Body::new(&mut pose, &world_from_model), &upper));
    /// pose.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
    /// assert!(query.any_in_region(Body::new(&mut pose, &world_from_model), &upper));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn any_in_region(&mut self, body: Body<'_>, region: &ConvexRegion) -> bool {
        self.in_region_up_to(body, region, 0, &mut Vec::new())
    }

    /// Appends the triangles that share a point with a convex region, in ascending order. As exact as [`ShapeQuery::any_in_region`].
    pub fn all_in_region(&mut self, body: Body<'_>, region: &ConvexRegion, triangles: &mut Vec<u32>) {
        let start = triangles.len();
        self.in_region_up_to(body, region, usize::MAX, triangles);
        triangles[start..].sort_unstable();
    }

    /// Appends at most `limit` triangles in no particular order; returns whether there are more.
    fn in_region_up_to(
        &mut self,
        mut body: Body<'_>,
        region: &ConvexRegion,
        limit: usize,
        triangles: &mut Vec<u32>,
    ) -> bool {
        let placed = body.posed().placed_body().placed;
        let to_model = |plane: &Plane| ModelPlane::new(plane.normal, plane.offset, &placed);
        let planes: Vec<_> = region.planes.iter().map(to_model).collect();
        let reached = |bounds: &Box64| planes.iter().all(|plane| plane.reaches(bounds)).then_some(0.0);
        let mut listed = Capped::new(triangles, limit);
        let _stopped_early = self.one.walk(body, 0.0, &ByBox(reached), &mut |number, triangle| {
            if triangle_meets_region(triangle, &region.planes) {
                listed.push(number)?;
            }
            ControlFlow::Continue(0.0)
        });
        listed.is_truncated
    }
}
