use glam::DVec3;

use crate::bounds::WorldFromModel;
use crate::exact::Triangle;
use crate::pose::{Pose, Posed};

/// A pose and its placement, borrowed for one query.
#[derive(Debug)]
pub struct Body<'a> {
    /// The shape. Queries blend the bounds and vertices they need into its cache.
    pub pose: &'a mut Pose,
    /// The placement. That of a skinned mesh is not used: its joints place it.
    pub world_from_model: &'a WorldFromModel,
}

impl<'a> Body<'a> {
    /// Pairs a pose with its placement.
    #[must_use]
    pub fn new(pose: &'a mut Pose, world_from_model: &'a WorldFromModel) -> Self {
        Self { pose, world_from_model }
    }

    /// Borrows the same body again, for one query of several.
    #[must_use]
    pub fn reborrow(&mut self) -> Body<'_> {
        Body::new(self.pose, self.world_from_model)
    }

    /// The position of a welded vertex in world space, or `None` if there is no such vertex.
    pub fn vertex(&mut self, vertex: u32) -> Option<DVec3> {
        let exists = (vertex as usize) < self.pose.bvh().model().vertex_count();
        exists.then(|| self.posed().world_vertex(vertex))
    }

    /// The corners of a triangle in world space, or `None` if there is no such triangle.
    pub fn triangle(&mut self, triangle: u32) -> Option<Triangle> {
        let exists = (triangle as usize) < self.pose.bvh().model().triangle_count();
        exists.then(|| self.posed().world_triangle(triangle))
    }

    pub(crate) fn posed(&mut self) -> Posed<'_> {
        self.pose.posed_at(self.world_from_model)
    }
}
