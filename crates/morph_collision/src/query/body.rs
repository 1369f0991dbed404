use glam::DVec3;

use crate::bounds::WorldFromModel;
use crate::exact::Triangle;
use crate::pose::{Pose, Posed};

/// A pose and its placement, borrowed for one query.
#[derive(Debug)]
pub struct Body<'a> {
    /// The shape. Queries blend the bounds and vertices they need into its cache.
    pub pose: &'a mut Pose,
    /// The placement.
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

    /// The largest absolute model-space coordinates.
    pub(super) fn magnitude(&mut self) -> DVec3 {
        self.pose.bounds().magnitude().as_dvec3()
    }
}

/// A triangle's corners in world space.
#[inline]
pub(super) fn world_triangle(tree: &mut Posed<'_>, world_from_model: &WorldFromModel, triangle: u32) -> Triangle {
    tree.corners(triangle)
        .map(|corner| world_from_model.transform_point(corner))
}
