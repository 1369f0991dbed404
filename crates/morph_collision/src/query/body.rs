use crate::bounds::WorldFromModel;
use crate::exact::Triangle;
use crate::pose::{Pose, Posed};

/// A posed mesh and where it stands, for the time of one query.
#[derive(Debug)]
pub struct Body<'a> {
    /// The shape; boxes and vertices that the query looks at are blended into its cache.
    pub pose: &'a mut Pose,
    /// The place.
    pub world_from_model: &'a WorldFromModel,
}

impl<'a> Body<'a> {
    /// A pose at a place.
    #[must_use]
    pub fn new(pose: &'a mut Pose, world_from_model: &'a WorldFromModel) -> Self {
        Self { pose, world_from_model }
    }

    /// The same body, for a query that is not the last one.
    #[must_use]
    pub fn reborrow(&mut self) -> Body<'_> {
        Body::new(self.pose, self.world_from_model)
    }
}

/// A triangle's corners in world space.
#[inline]
pub(super) fn world_triangle(tree: &mut Posed<'_>, world_from_model: &WorldFromModel, triangle: u32) -> Triangle {
    let [a, b, c] = tree.corners(triangle);
    [
        world_from_model.transform_point(a),
        world_from_model.transform_point(b),
        world_from_model.transform_point(c),
    ]
}
