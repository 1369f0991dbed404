//! Queries for everything in a region.

use bevy::camera::primitives::Frustum;
use bevy::prelude::*;
use bevy::shape::Aabb3d;
use morph_collision::{Aabb, ConvexRegion, InputError};

use super::target::Target;
use super::{MorphQueryFilter, MorphSpatialQuery};

impl MorphSpatialQuery<'_, '_> {
    /// The colliders whose boxes intersect an axis-aligned box, ascending: a cheap first filter. These are the broad-phase boxes,
    /// which contain everything a collider may reach, without its margin.
    ///
    /// To test surfaces against a box, use [`MorphSpatialQuery::shape_intersections`] with a cuboid.
    #[must_use]
    pub fn aabb_intersections_with_aabb(&self, aabb: Aabb3d, filter: &MorphQueryFilter) -> Vec<Entity> {
        self.aabb_intersections_with_aabb_predicate(aabb, filter, |_| true)
    }

    /// [`MorphSpatialQuery::aabb_intersections_with_aabb`] for colliders that a predicate accepts.
    #[must_use]
    pub fn aabb_intersections_with_aabb_predicate(
        &self,
        aabb: Aabb3d,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Vec<Entity> {
        let mut met = Vec::new();
        let aabb = Aabb {
            min: aabb.min.into(),
            max: aabb.max.into(),
        };
        if self.valid("aabb_intersections_with_aabb", check(&aabb)).is_none() {
            return met;
        }
        let overlaps = |bounds: &Aabb| aabb.overlaps(bounds).then_some(0.0);
        self.walk(filter, &mut predicate, 0.0, overlaps, |_, entity, _| {
            met.push(entity);
            0.0
        });
        met.sort_unstable();
        met
    }

    /// The colliders that a camera with this frustum could see, ascending: meshes whose surface is inside or intersects it, and
    /// shapes whose boxes do.
    ///
    /// Planes that are not finite, such as that of an infinite far plane, are ignored.
    #[must_use]
    pub fn frustum_intersections(&self, frustum: &Frustum, filter: &MorphQueryFilter) -> Vec<Entity> {
        self.frustum_intersections_predicate(frustum, filter, |_| true)
    }

    /// [`MorphSpatialQuery::frustum_intersections`] for colliders that a predicate accepts.
    #[must_use]
    pub fn frustum_intersections_predicate(
        &self,
        frustum: &Frustum,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Vec<Entity> {
        let mut met = Vec::new();
        let sides = frustum.half_spaces.iter();
        let mut half_spaces: Vec<_> = sides
            .map(|side| (side.normal().as_dvec3(), f64::from(side.d())))
            .collect();
        half_spaces.retain(|side| ConvexRegion::from_half_spaces(std::slice::from_ref(side)).is_ok());
        let Some(region) = self.valid("frustum_intersections", ConvexRegion::from_half_spaces(&half_spaces)) else {
            return met;
        };
        // The box's innermost corner decides.
        let reaches = |bounds: &Aabb| {
            let inside = half_spaces.iter().all(|(normal, offset)| {
                let corner = Vec3::select(normal.cmpgt(bevy::math::DVec3::ZERO), bounds.max, bounds.min).as_dvec3();
                let slack = 1e-6 * (normal.abs().dot(corner.abs()) + offset.abs());
                let inside = normal.dot(corner) + offset;
                inside.is_nan() || inside >= -slack
            });
            inside.then_some(0.0)
        };
        self.walk(filter, &mut predicate, 0.0, reaches, |queries, entity, target| {
            let meets = match target {
                Target::Mesh(body) => queries.shape.any_in_region(body, &region),
                Target::Shape(_) => true,
            };
            met.extend(meets.then_some(entity));
            0.0
        });
        met.sort_unstable();
        met
    }
}

/// Infinite boxes are allowed.
fn check(aabb: &Aabb) -> Result<(), InputError> {
    let finite = |v: Vec3| v.map(|x| x.clamp(f32::MIN, f32::MAX));
    ConvexRegion::from_aabb(&Aabb {
        min: finite(aabb.min),
        max: finite(aabb.max),
    })?;
    Ok(())
}
