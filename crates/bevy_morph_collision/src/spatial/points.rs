//! Queries about points: the closest surface, and the colliders that contain a point.

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::{Aabb, ClosestPoint, InputError, PlacedShape, Rank};

use super::rays::{HitRank, RayCast, renamed};
use super::target::Target;
use super::walker::Walker;
use super::{MorphProjection, MorphQueryFilter, MorphSpatialQuery};
use crate::contacts::MorphContact;

impl MorphSpatialQuery<'_, '_> {
    /// The closest point on any mesh or in any shape, at most `max_distance` away, which may be infinite.
    ///
    /// Among equal distances (before they are rounded to `f32`), the lowest entity wins, and then the lowest triangle.
    #[must_use]
    pub fn project_point(&self, point: Vec3, max_distance: f32, filter: &MorphQueryFilter) -> Option<MorphProjection> {
        self.project_point_predicate(point, max_distance, filter, |_| true)
    }

    /// [`MorphSpatialQuery::project_point`] for colliders that a predicate accepts.
    #[must_use]
    pub fn project_point_predicate(
        &self,
        point: Vec3,
        max_distance: f32,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Option<MorphProjection> {
        self.valid("project_point", checked_distance(point, max_distance))?;
        let closest = self
            .walker()?
            .closest_point(point, max_distance, filter, &mut predicate)?;
        Some(self.projection(&closest))
    }

    pub(super) fn projection(&self, (rank, found): &(HitRank, Closest)) -> MorphProjection {
        let (entity, triangle) = rank.id;
        let barycentrics = found
            .on_mesh
            .map_or(DVec3::ZERO, |closest| DVec3::from_array(closest.barycentrics))
            .as_vec3();
        MorphProjection {
            entity,
            distance: found.distance as f32,
            point: found.point.as_vec3(),
            normal: found.normal,
            triangle,
            barycentrics,
            uv: self.uv(entity, triangle, barycentrics),
            joint: self.joint(entity, triangle, barycentrics),
        }
    }

    /// The colliders that contain a point, ascending: shapes, and meshes that enclose it or have it on their surface.
    ///
    /// To decide whether a mesh encloses a point, the query casts a ray from it and counts how often the ray leaves through the
    /// front of a triangle and how often it enters. A mesh with holes has no inside; near its holes either answer is possible.
    #[must_use]
    pub fn point_intersections(&self, point: Vec3, filter: &MorphQueryFilter) -> Vec<Entity> {
        self.point_intersections_predicate(point, filter, |_| true)
    }

    /// [`MorphSpatialQuery::point_intersections`] for colliders that a predicate accepts.
    #[must_use]
    pub fn point_intersections_predicate(
        &self,
        point: Vec3,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Vec<Entity> {
        let mut met = Vec::new();
        if self
            .valid("point_intersections", checked_distance(point, 0.0))
            .is_none()
        {
            return met;
        }
        let holds = |bounds: &Aabb| bounds.contains(point).then_some(0.0);
        self.walk(filter, &mut predicate, 0.0, holds, |queries, entity, target| {
            let holds = match target {
                Target::Mesh(body) => queries.ray.encloses(body, point.as_dvec3()).unwrap_or(false),
                Target::Shape(shape) => shape.signed_distance(point.as_dvec3()) <= 0.0,
            };
            met.extend(holds.then_some(entity));
            0.0
        });
        met.sort_unstable();
        met
    }
}

impl Walker<'_, '_, '_> {
    /// The closest point, for valid input.
    pub(super) fn closest_point(
        &mut self,
        point: Vec3,
        max_distance: f32,
        filter: &MorphQueryFilter,
        predicate: &mut dyn FnMut(Entity) -> bool,
    ) -> Option<(HitRank, Closest)> {
        let (from, within) = (point.as_dvec3(), f64::from(max_distance));
        let near = |bounds: &Aabb| Some(away(bounds, point));
        let mut best: Option<(HitRank, Closest)> = None;
        self.walk(filter, predicate, max_distance, near, |queries, entity, target| {
            let limit = best.as_ref().map_or(within, |(_, found)| found.distance);
            let found = match target {
                Target::Mesh(mut body) => match queries.shape.closest_point(body.reborrow(), from, limit) {
                    Ok(Some(closest)) => Some(Closest {
                        distance: closest.distance,
                        point: closest.point,
                        normal: body.triangle(closest.triangle).map_or(Vec3::ZERO, normal_of),
                        on_mesh: Some(closest),
                    }),
                    _ => None,
                },
                Target::Shape(shape) => Some(Closest::in_shape(shape, from)).filter(|found| found.distance <= limit),
            };
            let found = found.map(|found| (Rank::new(found.distance, (entity, found.triangle())), found));
            let is_closest = |(rank, _): &(HitRank, _)| best.as_ref().is_none_or(|(closest, _)| rank < closest);
            if let Some(found) = found.filter(is_closest) {
                best = Some(found);
            }
            best.as_ref()
                .map_or(max_distance, |(_, found)| (found.distance as f32).next_up())
        });
        best
    }
}

/// The point of a collider that is closest to another point.
pub(super) struct Closest {
    distance: f64,
    point: DVec3,
    normal: Vec3,
    on_mesh: Option<ClosestPoint>,
}

impl Closest {
    fn triangle(&self) -> u32 {
        self.on_mesh
            .map_or(MorphContact::NO_TRIANGLE, |closest| closest.triangle)
    }

    fn in_shape(shape: &PlacedShape, from: DVec3) -> Self {
        let point = shape.closest_point(from);
        Self {
            distance: point.distance(from),
            point,
            normal: towards(point, from),
            on_mesh: None,
        }
    }
}

fn normal_of([a, b, c]: morph_collision::Triangle) -> Vec3 {
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// A lower bound of the distance between a point and a box.
fn away(bounds: &Aabb, point: Vec3) -> f32 {
    let outside = (bounds.min - point).max(point - bounds.max).max(Vec3::ZERO);
    outside.length() * (1.0 - 1e-6)
}

/// The unit vector from one point towards another; zero if they coincide.
fn towards(from: DVec3, to: DVec3) -> Vec3 {
    (to - from).normalize_or_zero().as_vec3()
}

pub(super) fn checked_distance(point: Vec3, max_distance: f32) -> Result<f64, InputError> {
    // The ray constructor reports which number is invalid.
    match RayCast::new(point, Dir3::X, max_distance) {
        Ok(_) => Ok(f64::from(max_distance)),
        Err(error) => Err(renamed(error, "origin", "point")),
    }
}
