//! Ray casts.

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::{Aabb, Facing, InputError, PlacedShape, Ray, RayHit, ShapeImpact};

use super::query::Target;
use super::{MorphQueryFilter, MorphRayHit, MorphSpatialQuery};
use crate::contacts::MorphContact;

/// What a ray hits: a triangle of a mesh, or a shape.
enum Met {
    Triangle(RayHit),
    Shape(ShapeImpact),
}

impl Met {
    fn distance(&self) -> f64 {
        match self {
            Self::Triangle(hit) => hit.distance,
            Self::Shape(impact) => impact.distance,
        }
    }
}

impl MorphSpatialQuery<'_, '_> {
    /// The first hit of a ray, at most `max_distance` away, which may be infinite.
    #[must_use]
    pub fn cast_ray(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Option<MorphRayHit> {
        self.cast_ray_predicate(origin, direction, max_distance, filter, |_| true)
    }

    /// [`MorphSpatialQuery::cast_ray`] for colliders that a predicate accepts.
    #[must_use]
    pub fn cast_ray_predicate(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Option<MorphRayHit> {
        let (mut ray, point) = self.valid("cast_ray", checked_ray(origin, direction, max_distance))?;
        let mut within = max_distance;
        let enters = |bounds: &Aabb| enters(bounds, origin, *direction, max_distance);
        let mut best: Option<(Entity, Met)> = None;
        self.walk(
            filter,
            &mut predicate,
            max_distance,
            enters,
            |queries, entity, target| {
                let met = match target {
                    Target::Mesh(body) => queries
                        .ray
                        .closest_where(body, &ray, |hit| filter.sees(hit))
                        .map(Met::Triangle),
                    Target::Shape(shape) => meets_shape(&point, direction, within, shape),
                };
                let is_first = |met: &Met| match &best {
                    Some((other, before)) => (met.distance(), entity) < (before.distance(), *other),
                    None => true,
                };
                if let Some(met) = met.filter(is_first) {
                    // Hits at the same distance may differ by rounding.
                    within = ((met.distance() * (1.0 + 1e-6)) as f32).next_up().min(max_distance);
                    if let Ok((shorter, _)) = checked_ray(origin, direction, within) {
                        ray = shorter;
                    }
                    best = Some((entity, met));
                }
                within
            },
        );
        best.map(|(entity, met)| self.ray_hit(entity, &met))
    }

    /// All hits of a ray: every triangle of meshes, and shapes where the ray enters them. Sorted by distance, then by entity and
    /// triangle.
    #[must_use]
    pub fn ray_hits(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Vec<MorphRayHit> {
        self.ray_hits_predicate(origin, direction, max_distance, filter, |_| true)
    }

    /// [`MorphSpatialQuery::ray_hits`] for colliders that a predicate accepts.
    #[must_use]
    pub fn ray_hits_predicate(
        &self,
        origin: Vec3,
        direction: Dir3,
        max_distance: f32,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Vec<MorphRayHit> {
        let Some((ray, point)) = self.valid("ray_hits", checked_ray(origin, direction, max_distance)) else {
            return Vec::new();
        };
        let enters = |bounds: &Aabb| enters(bounds, origin, *direction, max_distance);
        let mut all: Vec<(Entity, Met)> = Vec::new();
        self.walk(
            filter,
            &mut predicate,
            max_distance,
            enters,
            |queries, entity, target| {
                match target {
                    Target::Mesh(body) => {
                        queries.hits.clear();
                        queries.ray.all(body, &ray, &mut queries.hits);
                        let seen = queries.hits.drain(..).filter(|hit| filter.sees(hit));
                        all.extend(seen.map(|hit| (entity, Met::Triangle(hit))));
                    }
                    Target::Shape(shape) => {
                        let met = meets_shape(&point, direction, max_distance, shape);
                        all.extend(met.map(|met| (entity, met)));
                    }
                }
                max_distance
            },
        );
        let mut all: Vec<_> = all.iter().map(|(entity, met)| self.ray_hit(*entity, met)).collect();
        all.sort_by(|x, y| {
            let place = x.distance.total_cmp(&y.distance);
            place.then(x.entity.cmp(&y.entity)).then(x.triangle.cmp(&y.triangle))
        });
        all
    }

    fn ray_hit(&self, entity: Entity, met: &Met) -> MorphRayHit {
        match met {
            Met::Triangle(hit) => {
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
            Met::Shape(impact) => MorphRayHit {
                entity,
                distance: impact.distance as f32,
                point: impact.point.as_vec3(),
                normal: impact.normal.as_vec3(),
                facing: Facing::Front,
                triangle: MorphContact::NO_TRIANGLE,
                barycentrics: Vec3::ZERO,
                uv: None,
                joint: None,
            },
        }
    }
}

/// A ray, and a point to cast along it.
pub(super) fn checked_ray(origin: Vec3, direction: Dir3, max_distance: f32) -> Result<(Ray, PlacedShape), InputError> {
    let ray = Ray::new(origin.as_dvec3(), direction.as_dvec3(), f64::from(max_distance));
    let ray = ray.map_err(|error| renamed(error, "max_t", "max_distance"))?;
    Ok((ray, PlacedShape::ball(origin.as_dvec3(), 0.0)?))
}

/// Renames the number in an error to what the called method calls it.
pub(super) fn renamed(mut error: InputError, from: &str, to: &str) -> InputError {
    if let InputError::BadCoordinate { what, .. } | InputError::BadNumber { what, .. } = &mut error
        && what == from
    {
        *what = to.to_owned();
    }
    error
}

/// Where a point enters a solid shape. From inside, it hits at once and has no normal.
fn meets_shape(point: &PlacedShape, direction: Dir3, max_distance: f32, shape: &PlacedShape) -> Option<Met> {
    let impact = point
        .cast(direction.as_dvec3(), f64::from(max_distance), shape)
        .ok()??;
    let starts_inside = point.meets(shape);
    let normal = if starts_inside { DVec3::ZERO } else { impact.normal };
    Some(Met::Shape(ShapeImpact { normal, ..impact }))
}

/// A lower bound of the distance at which a ray enters a box; `None` if it certainly misses it.
pub(super) fn enters(bounds: &Aabb, origin: Vec3, direction: Vec3, max_distance: f32) -> Option<f32> {
    let (mut first, mut last) = (0.0_f64, f64::from(max_distance));
    let size = (bounds.min.abs().max(bounds.max.abs()) + origin.abs()).max_element();
    if !size.is_finite() {
        return Some(0.0);
    }
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
    // Slack for rounding.
    (first <= last + slack).then_some(((first - slack) * (1.0 - 1e-6)) as f32)
}

impl MorphQueryFilter {
    fn sees(&self, hit: &RayHit) -> bool {
        !self.only_front || hit.facing != Facing::Back
    }
}
