//! Ray casts.

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::{Aabb, Facing, InputError, PlacedShape, Rank, Ray, RayHit, ShapeImpact};

use super::target::Target;
use super::walker::Walker;
use super::{MorphQueryFilter, MorphRayHit, MorphSpatialQuery};
use crate::contacts::MorphContact;

/// What a ray hits: a triangle of a mesh, or a shape.
enum Met {
    Triangle(RayHit),
    Shape(ShapeImpact),
}

/// A hit and its place among all hits of a ray.
pub(super) struct Ranked {
    /// By the parameter of the ray: it is the same for all surfaces that the ray hits at the same point. Distances are products with
    /// the length of the direction, so different parameters may have the same distance.
    rank: HitRank,
    met: Met,
}

/// Hits of the same distance come in the order of their entities, and then of their triangles.
pub(super) type HitRank = Rank<(Entity, u32)>;

impl Ranked {
    fn triangle(entity: Entity, hit: RayHit) -> Self {
        Self {
            rank: Rank::new(hit.t, (entity, hit.triangle)),
            met: Met::Triangle(hit),
        }
    }

    fn shape(entity: Entity, impact: ShapeImpact, direction: Dir3) -> Self {
        let length = direction.as_dvec3().length();
        let t = impact.distance / length;
        // Distances have to be in the order of the parameters.
        let distance = t * length;
        Self {
            rank: Rank::new(t, (entity, MorphContact::NO_TRIANGLE)),
            met: Met::Shape(ShapeImpact { distance, ..impact }),
        }
    }
}

impl MorphSpatialQuery<'_, '_> {
    /// The first hit of a ray, at most `max_distance` away, which may be infinite. It is the first one of
    /// [`MorphSpatialQuery::ray_hits`].
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
        let cast = self.valid("cast_ray", RayCast::new(origin, direction, max_distance))?;
        let hit = self.walker()?.first_hit(&cast, filter, &mut predicate)?;
        Some(self.ray_hit(&hit))
    }

    /// All hits of a ray: every triangle of meshes, and shapes where the ray enters them.
    ///
    /// Sorted by distance before it is rounded to `f32`, then by entity, then by triangle. Meshes whose surfaces coincide are at exactly
    /// the same distance.
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
        let Some(cast) = self.valid("ray_hits", RayCast::new(origin, direction, max_distance)) else {
            return Vec::new();
        };
        let hits = self
            .walker()
            .map(|mut walker| walker.all_hits(&cast, filter, &mut predicate));
        hits.iter().flatten().map(|hit| self.ray_hit(hit)).collect()
    }

    pub(super) fn ray_hit(&self, Ranked { rank, met }: &Ranked) -> MorphRayHit {
        let (entity, _) = rank.id;
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

impl Walker<'_, '_, '_> {
    /// All hits of a ray, sorted.
    pub(super) fn all_hits(
        &mut self,
        cast: &RayCast,
        filter: &MorphQueryFilter,
        predicate: &mut dyn FnMut(Entity) -> bool,
    ) -> Vec<Ranked> {
        let RayCast {
            origin,
            direction,
            max_distance,
            ..
        } = *cast;
        let entry = BoxEntry::new(origin, direction, max_distance);
        let enters = |bounds: &Aabb| entry.distance(bounds);
        let mut all: Vec<Ranked> = Vec::new();
        self.walk(filter, predicate, max_distance, enters, |queries, entity, target| {
            match target {
                Target::Mesh(body) => {
                    queries.hits.clear();
                    queries.ray.all(body, &cast.ray, &mut queries.hits);
                    let seen = queries.hits.drain(..).filter(|hit| filter.sees(hit));
                    all.extend(seen.map(|hit| Ranked::triangle(entity, hit)));
                }
                Target::Shape(shape) => {
                    let impact = meets_shape(&cast.point, direction, max_distance, shape);
                    all.extend(impact.map(|impact| Ranked::shape(entity, impact, direction)));
                }
            }
            max_distance
        });
        all.sort_unstable_by_key(|hit| hit.rank);
        all
    }

    /// The first hit of a ray.
    pub(super) fn first_hit(
        &mut self,
        cast: &RayCast,
        filter: &MorphQueryFilter,
        predicate: &mut dyn FnMut(Entity) -> bool,
    ) -> Option<Ranked> {
        let RayCast {
            origin,
            direction,
            max_distance,
            mut ray,
            ref point,
        } = *cast;
        let mut within = max_distance;
        let entry = BoxEntry::new(origin, direction, max_distance);
        let enters = |bounds: &Aabb| entry.distance(bounds);
        let mut first: Option<Ranked> = None;
        self.walk(filter, predicate, max_distance, enters, |queries, entity, target| {
            let hit = match target {
                Target::Mesh(body) => queries
                    .ray
                    .closest_where(body, &ray, |hit| filter.sees(hit))
                    .map(|hit| Ranked::triangle(entity, hit)),
                Target::Shape(shape) => {
                    meets_shape(point, direction, within, shape).map(|impact| Ranked::shape(entity, impact, direction))
                }
            };
            let is_first = |hit: &Ranked| first.as_ref().is_none_or(|first| hit.rank < first.rank);
            if let Some(hit) = hit.filter(is_first) {
                // A margin for the roundings of other hits, and for a direction whose length is not quite 1.
                within = ((hit.rank.distance * (1.0 + 1e-6)) as f32).next_up().min(max_distance);
                if let Ok(shorter) = RayCast::new(origin, direction, within) {
                    ray = shorter.ray;
                }
                first = Some(hit);
            }
            within
        });
        first
    }
}

/// A ray, and a point to cast along it.
pub(super) struct RayCast {
    pub(super) origin: Vec3,
    pub(super) direction: Dir3,
    max_distance: f32,
    ray: Ray,
    point: PlacedShape,
}

impl RayCast {
    pub(super) fn new(origin: Vec3, direction: Dir3, max_distance: f32) -> Result<Self, InputError> {
        let ray = Ray::new(origin.as_dvec3(), direction.as_dvec3(), f64::from(max_distance));
        Ok(Self {
            origin,
            direction,
            max_distance,
            ray: ray.map_err(|error| renamed(error, "max_t", "max_distance"))?,
            point: PlacedShape::ball(origin.as_dvec3(), 0.0)?,
        })
    }
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
fn meets_shape(point: &PlacedShape, direction: Dir3, max_distance: f32, shape: &PlacedShape) -> Option<ShapeImpact> {
    let impact = point
        .cast(direction.as_dvec3(), f64::from(max_distance), shape)
        .ok()??;
    let starts_inside = point.meets(shape);
    let normal = if starts_inside { DVec3::ZERO } else { impact.normal };
    Some(ShapeImpact { normal, ..impact })
}

/// A ray, prepared to find where it enters boxes.
pub(super) struct BoxEntry {
    origin: DVec3,
    inverse_direction: DVec3,
    max_distance: f64,
    /// The largest absolute coordinate of the origin.
    size: f32,
}

impl BoxEntry {
    pub(super) fn new(origin: Vec3, direction: Dir3, max_distance: f32) -> Self {
        // Not infinite, so that no product is NaN.
        let inverse = |component: f64| if component == 0.0 { f64::MAX } else { 1.0 / component };
        Self {
            origin: origin.as_dvec3(),
            inverse_direction: direction.as_dvec3().map(inverse),
            max_distance: f64::from(max_distance),
            size: origin.abs().max_element(),
        }
    }

    /// A lower bound of the distance at which the ray enters a box; `None` if it certainly misses it.
    pub(super) fn distance(&self, bounds: &Aabb) -> Option<f32> {
        let size = bounds.min.abs().max(bounds.max.abs()).max_element() + self.size;
        if !size.is_finite() {
            return Some(0.0);
        }
        let slack = f64::from(size) * 1e-6;
        let low = (bounds.min.as_dvec3() - self.origin - slack) * self.inverse_direction;
        let high = (bounds.max.as_dvec3() - self.origin + slack) * self.inverse_direction;
        let first = low.min(high).max_element().max(0.0);
        let last = low.max(high).min_element().min(self.max_distance);
        // Slack for rounding.
        (first <= last + slack).then_some(((first - slack) * (1.0 - 1e-6)) as f32)
    }
}

impl MorphQueryFilter {
    fn sees(&self, hit: &RayHit) -> bool {
        !self.only_front || hit.facing != Facing::Back
    }
}
