//! What lies in a region.

use bevy::camera::primitives::Frustum;
use bevy::prelude::*;
use morph_collision::{Aabb, Ball, ConvexRegion, HalfSpace, InputError};

use super::points::away;
use super::{MorphQueryFilter, MorphSpatialQuery};

impl MorphSpatialQuery<'_, '_> {
    /// The colliders whose surface meets a solid ball, ascending.
    ///
    /// # Errors
    /// Numbers that are not finite; a negative radius.
    pub fn overlap_ball(
        &mut self,
        center: Vec3,
        radius: f32,
        filter: &MorphQueryFilter,
    ) -> Result<Vec<Entity>, InputError> {
        let ball = Ball::new(center.as_dvec3(), f64::from(radius))?;
        let near = self.near(filter, |bounds| (away(bounds, center) <= radius).then_some(0.0));
        Ok(self.meeting(near, |queries, body| queries.overlap.meets_ball(body, &ball).0))
    }

    /// The colliders whose surface meets a solid box along the axes, ascending.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn overlap_box(&mut self, min: Vec3, max: Vec3, filter: &MorphQueryFilter) -> Result<Vec<Entity>, InputError> {
        let wanted = Aabb { min, max };
        let region = ConvexRegion::from_box(&wanted)?;
        let near = self.near(filter, |bounds| wanted.overlaps(bounds).then_some(0.0));
        Ok(self.meeting(near, |queries, body| queries.overlap.meets_region(body, &region).0))
    }

    /// The colliders whose surface is inside a frustum or meets it, ascending: what a camera with this frustum could see.
    ///
    /// Sides that are not finite, as that of an infinite far plane, are left out.
    pub fn overlap_frustum(&mut self, frustum: &Frustum, filter: &MorphQueryFilter) -> Vec<Entity> {
        let side = |side: &bevy::shape::HalfSpace| HalfSpace::new(side.normal().as_dvec3(), f64::from(side.d())).ok();
        let half_spaces: Vec<_> = frustum.half_spaces.iter().filter_map(side).collect();
        let region = ConvexRegion::from_half_spaces(&half_spaces);
        let near = self.near(filter, |_| Some(0.0));
        self.meeting(near, |queries, body| queries.overlap.meets_region(body, &region).0)
    }
}
