//! Rays.

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::{Aabb, Facing, InputError, Ray, RayHit};

use super::query::body;
use super::{MorphQueryFilter, MorphRayHit, MorphSpatialQuery};

impl MorphSpatialQuery<'_, '_> {
    /// The first hit of a ray, at most `max_distance` away, which may be infinite.
    ///
    /// # Errors
    /// Numbers that are not finite; a negative distance.
    pub fn cast_ray(
        &mut self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Result<Option<MorphRayHit>, InputError> {
        self.cast_ray_where(origin, direction, max_distance, filter, |_| true)
    }

    /// The first hit of a ray on a collider that a predicate accepts.
    ///
    /// # Errors
    /// As [`MorphSpatialQuery::cast_ray`].
    pub fn cast_ray_where(
        &mut self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Result<Option<MorphRayHit>, InputError> {
        let ray = world_ray(origin, direction, max_distance)?;
        let near = self.near(filter, |bounds| enters(bounds, origin, *direction, max_distance));
        let mut best: Option<(Entity, RayHit)> = None;
        for &(entry, entity) in &near {
            if best.is_some_and(|(_, hit)| f64::from(entry) > hit.distance) {
                break;
            }
            if !predicate(entity) {
                continue;
            }
            let Ok((_, mut state)) = self.colliders.get_mut(entity) else {
                continue;
            };
            let Some(body) = body(&mut state) else { continue };
            let hit = self.queries.ray.closest_where(body, &ray, |hit| filter.sees(hit));
            if let Some(hit) = hit.filter(|hit| best.is_none_or(|(_, before)| hit.distance < before.distance)) {
                best = Some((entity, hit));
            }
        }
        self.queries.near = near;
        Ok(best.map(|(entity, hit)| self.ray_hit(entity, &hit)))
    }

    /// Every triangle that a ray hits, nearest first; among equals by entity and triangle.
    ///
    /// # Errors
    /// As [`MorphSpatialQuery::cast_ray`].
    pub fn ray_hits(
        &mut self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Result<Vec<MorphRayHit>, InputError> {
        let ray = world_ray(origin, direction, max_distance)?;
        let near = self.near(filter, |bounds| enters(bounds, origin, *direction, max_distance));
        let mut all = Vec::new();
        for &(_, entity) in &near {
            let mut hits = std::mem::take(&mut self.queries.hits);
            hits.clear();
            if let Ok((_, mut state)) = self.colliders.get_mut(entity)
                && let Some(body) = body(&mut state)
            {
                self.queries.ray.all(body, &ray, &mut hits);
            }
            let seen = hits.iter().filter(|hit| filter.sees(hit));
            all.extend(seen.map(|hit| self.ray_hit(entity, hit)));
            self.queries.hits = hits;
        }
        self.queries.near = near;
        all.sort_by(|x: &MorphRayHit, y| {
            let place = x.distance.total_cmp(&y.distance);
            place.then(x.entity.cmp(&y.entity)).then(x.triangle.cmp(&y.triangle))
        });
        Ok(all)
    }

    fn ray_hit(&self, entity: Entity, hit: &RayHit) -> MorphRayHit {
        let barycentrics = DVec3::from_array(hit.barycentrics).as_vec3();
        MorphRayHit {
            entity,
            distance: hit.distance as f32,
            point: hit.point.as_vec3(),
            normal: hit.normal.as_vec3(),
            facing: hit.facing,
            triangle: hit.triangle,
            barycentrics,
            uv: self.uv(entity, hit.triangle, barycentrics),
            joint: self.joint(entity, hit.triangle, barycentrics),
        }
    }
}

fn world_ray(origin: Vec3, direction: Dir3, max_distance: f32) -> Result<Ray, InputError> {
    Ray::new(origin.as_dvec3(), direction.as_dvec3(), f64::from(max_distance))
}

/// A lower bound of the distance at which a ray enters a box; `None` if it certainly misses it.
fn enters(bounds: &Aabb, origin: Vec3, direction: Vec3, max_distance: f32) -> Option<f32> {
    let (mut first, mut last) = (0.0_f64, f64::from(max_distance));
    let size = (bounds.min.abs().max(bounds.max.abs()) + origin.abs()).max_element();
    let slack = f64::from(size) * 1e-6;
    for i in 0..3 {
        let (origin, direction) = (f64::from(origin[i]), f64::from(direction[i]));
        let (low, high) = (
            f64::from(bounds.min[i]) - slack - origin,
            f64::from(bounds.max[i]) + slack - origin,
        );
        if direction == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (near, far) = (low / direction, high / direction);
        first = first.max(near.min(far));
        last = last.min(near.max(far));
    }
    // Below what is rounded.
    (first <= last + slack).then_some(((first - slack) * (1.0 - 1e-6)) as f32)
}

impl MorphQueryFilter {
    fn sees(&self, hit: &RayHit) -> bool {
        !self.only_front || hit.facing != Facing::Back
    }
}
