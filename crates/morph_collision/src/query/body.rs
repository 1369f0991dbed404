//! A pose and its placement.

use std::ops::Range;

use glam::DVec3;

use crate::bounds::WorldFromModel;
use crate::exact::Triangle;
use crate::pose::{Pose, Posed, displacement};

/// A pose and its placement, borrowed for one query.
#[derive(Debug)]
pub struct Body<'a> {
    /// The shape. Queries blend the bounds and vertices they need into its cache.
    pub pose: &'a mut Pose,
    /// The placement. It is ignored for a skinned mesh, whose joints place it.
    pub world_from_model: &'a WorldFromModel,
}

impl<'a> Body<'a> {
    /// Creates a body from a pose and its placement.
    #[must_use]
    pub fn new(pose: &'a mut Pose, world_from_model: &'a WorldFromModel) -> Self {
        Self { pose, world_from_model }
    }

    /// Borrows the body again, to use it in several queries.
    #[must_use]
    pub fn reborrow(&mut self) -> Body<'_> {
        Body::new(self.pose, self.world_from_model)
    }

    /// Returns the position of a welded vertex in world space, or `None` if there is no such vertex.
    pub fn vertex(&mut self, vertex: u32) -> Option<DVec3> {
        let exists = (vertex as usize) < self.pose.bvh().model().vertex_count();
        exists.then(|| self.posed().world_vertex(vertex))
    }

    /// Returns the corners of a triangle in world space, or `None` if there is no such triangle.
    pub fn triangle(&mut self, triangle: u32) -> Option<Triangle> {
        let exists = (triangle as usize) < self.pose.bvh().model().triangle_count();
        exists.then(|| self.posed().world_triangle(triangle))
    }

    /// Returns a bound on how far any vertex has moved in world space since `before`, rounding included. Infinite for poses of different
    /// trees.
    ///
    /// It holds for the vertices of triangles, and so for every point of the surface.
    ///
    /// Cost: one pass over the targets and one over the joints. No vertex is blended. For a mesh without joints, up to two levels of the
    /// tree below the root's children are visited if that makes the bound smaller.
    #[must_use]
    pub fn displacement_from(&self, before: Body<'_>) -> f64 {
        self.displacement(before, 0.0..f64::INFINITY)
    }

    /// Returns whether [`Body::displacement_from`] is at most `distance`. Cheaper than computing the bound.
    #[must_use]
    pub fn moved_at_most(&self, distance: f64, before: Body<'_>) -> bool {
        self.displacement(before, distance..distance) <= distance
    }

    fn displacement(&self, before: Body<'_>, wanted: Range<f64>) -> f64 {
        displacement(
            before.pose,
            before.world_from_model,
            self.pose,
            self.world_from_model,
            wanted,
        )
    }

    pub(crate) fn posed(&mut self) -> Posed<'_> {
        self.pose.posed_at(self.world_from_model)
    }
}
