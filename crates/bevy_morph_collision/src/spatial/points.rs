//! Closest points, contacts of two colliders, and posed vertices.

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::{Aabb, Body, ClosestPoint, InputError};

use super::query::body;
use super::{MorphClosestPoints, MorphContacts, MorphProjection, MorphQueryFilter, MorphSpatialQuery};
use crate::narrow_phase::world_triangle;

impl MorphSpatialQuery<'_, '_> {
    /// The point closest to some point on the surface of any collider, at most `max_distance` away, which may be infinite.
    ///
    /// # Errors
    /// Numbers that are not finite; a negative distance.
    pub fn project_point(
        &mut self,
        point: Vec3,
        max_distance: f32,
        filter: &MorphQueryFilter,
    ) -> Result<Option<MorphProjection>, InputError> {
        let near = self.near(filter, |bounds| {
            Some(away(bounds, point)).filter(|&away| away <= max_distance)
        });
        let mut within = f64::from(max_distance);
        let mut best: Option<(Entity, ClosestPoint)> = None;
        for &(at_least, entity) in &near {
            if best.is_some_and(|(_, closest)| f64::from(at_least) > closest.distance) {
                break;
            }
            let Ok((_, mut state)) = self.colliders.get_mut(entity) else {
                continue;
            };
            let Some(body) = body(&mut state) else { continue };
            let closest = self.queries.shape.closest_point(body, point.as_dvec3(), within)?;
            if let Some(closest) = closest.filter(|new| best.is_none_or(|(_, old)| new.distance < old.distance)) {
                within = closest.distance;
                best = Some((entity, closest));
            }
        }
        self.queries.near = near;
        Ok(best.map(|(entity, closest)| {
            let barycentrics = DVec3::from_array(closest.barycentrics).as_vec3();
            MorphProjection {
                entity,
                distance: closest.distance as f32,
                point: closest.point.as_vec3(),
                normal: self.normal(entity, closest.triangle),
                triangle: closest.triangle,
                barycentrics,
                uv: self.uv(entity, closest.triangle, barycentrics),
                joint: self.joint(entity, closest.triangle, barycentrics),
            }
        }))
    }

    /// The closest points of two colliders, if they are at most `max_distance` apart; `None` also where one of them is not
    /// there.
    pub fn closest_points(&mut self, a: Entity, b: Entity, max_distance: f32) -> Option<MorphClosestPoints> {
        let Self { colliders, queries, .. } = self;
        let [mut a, mut b] = colliders.get_many_mut([a, b]).ok()?;
        let distance = &mut queries.distance;
        let closest = distance.closest(body(&mut a.1)?, body(&mut b.1)?, f64::from(max_distance));
        closest.ok()?.map(|closest| MorphClosestPoints {
            point1: closest.point_a.as_vec3(),
            point2: closest.point_b.as_vec3(),
            distance: closest.distance as f32,
            triangles: morph_collision::TrianglePair {
                triangle_a: closest.triangle_a,
                triangle_b: closest.triangle_b,
            },
        })
    }

    /// Where two colliders meet; `None` where they do not, or one of them is not there.
    ///
    /// It looks at [`MorphCollisionSettings::max_triangle_pairs`](crate::MorphCollisionSettings) pairs of triangles at most.
    pub fn contacts(&mut self, a: Entity, b: Entity) -> Option<MorphContacts> {
        let limit = self.list_limit();
        let Self { colliders, queries, .. } = self;
        let [mut a, mut b] = colliders.get_many_mut([a, b]).ok()?;
        let (body_a, body_b) = (body(&mut a.1)?, body(&mut b.1)?);
        let manifold = queries.contact.manifold_up_to(body_a, body_b, limit);
        manifold.as_ref().map(MorphContacts::from)
    }

    /// A box in world space around a collider as it is posed: conservative, from its tree's root alone.
    #[must_use]
    pub fn bounds(&self, collider: Entity) -> Option<Aabb> {
        let (_, state) = self.colliders.get(collider).ok()?;
        Some(state.placed?.bounds)
    }

    /// A vertex of a collider's mesh as it is posed, in world space.
    #[must_use]
    pub fn posed_vertex(&mut self, collider: Entity, vertex: u32) -> Option<Vec3> {
        let (_, mut state) = self.colliders.get_mut(collider).ok()?;
        let Body { pose, world_from_model } = body(&mut state)?;
        Some(world_from_model.transform_point(pose.source_vertex(vertex)?).as_vec3())
    }

    /// All vertices of a collider's mesh as they are posed, in world space, in the mesh's order. Blends the whole mesh.
    #[must_use]
    pub fn posed_vertices(&mut self, collider: Entity) -> Option<Vec<Vec3>> {
        let (_, mut state) = self.colliders.get_mut(collider).ok()?;
        let Body { pose, world_from_model } = body(&mut state)?;
        let posed = (0..).map_while(|vertex| pose.source_vertex(vertex));
        Some(posed.map(|p| world_from_model.transform_point(p).as_vec3()).collect())
    }

    /// The corners of a triangle of a collider's mesh as it is posed, in world space.
    #[must_use]
    pub fn posed_triangle(&mut self, collider: Entity, triangle: u32) -> Option<[Vec3; 3]> {
        let (_, mut state) = self.colliders.get_mut(collider).ok()?;
        Some(world_triangle(&mut body(&mut state)?, triangle)?.map(DVec3::as_vec3))
    }
}

/// A lower bound of the distance of a point from a box.
pub(super) fn away(bounds: &Aabb, point: Vec3) -> f32 {
    let outside = (bounds.min - point).max(point - bounds.max).max(Vec3::ZERO);
    outside.length() * (1.0 - 1e-6)
}
