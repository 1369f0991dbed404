//! What lies in a region.

use bevy::camera::primitives::Frustum;
use bevy::prelude::*;
use morph_collision::{Aabb, ConvexRegion, InputError, PlacedShape};

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
        let ball = PlacedShape::ball(center.as_dvec3(), f64::from(radius))?;
        let near = self.near(filter, |bounds| (away(bounds, center) <= radius).then_some(0.0));
        Ok(self.meeting(near, |queries, body| queries.shape.any(body, &ball)))
    }

    /// The colliders whose surface meets a solid box along the axes, ascending.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn overlap_box(&mut self, min: Vec3, max: Vec3, filter: &MorphQueryFilter) -> Result<Vec<Entity>, InputError> {
        let wanted = Aabb { min, max };
        let region = ConvexRegion::from_aabb(&wanted)?;
        let near = self.near(filter, |bounds| wanted.overlaps(bounds).then_some(0.0));
        Ok(self.meeting(near, |queries, body| queries.shape.any_in_region(body, &region)))
    }

    /// The colliders whose surface is inside a frustum or meets it, ascending: what a camera with this frustum could see.
    ///
    /// Sides that are not finite, as that of an infinite far plane, are left out.
    pub fn overlap_frustum(&mut self, frustum: &Frustum, filter: &MorphQueryFilter) -> Vec<Entity> {
        let sides = frustum.half_spaces.iter();
        let mut half_spaces: Vec<_> = sides
            .map(|side| (side.normal().as_dvec3(), f64::from(side.d())))
            .collect();
        half_spaces.retain(|side| ConvexRegion::from_half_spaces(std::slice::from_ref(side)).is_ok());
        let Ok(region) = ConvexRegion::from_half_spaces(&half_spaces) else {
            return Vec::new();
        };
        let near = self.near(filter, |_| Some(0.0));
        self.meeting(near, |queries, body| queries.shape.any_in_region(body, &region))
    }
}
