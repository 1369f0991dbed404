//! Queries for the current shape of a collider.

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::{Aabb, Body};

use super::MorphSpatialQuery;

impl MorphSpatialQuery<'_, '_> {
    /// A conservative world-space box around a collider in its current pose, computed from the root of its tree only.
    #[must_use]
    pub fn bounds(&self, collider: Entity) -> Option<Aabb> {
        Some(self.state(collider)?.placed.as_ref()?.bounds)
    }

    /// A vertex of a collider's mesh in its current pose, in world space.
    #[must_use]
    pub fn posed_vertex(&self, collider: Entity, vertex: u32) -> Option<Vec3> {
        self.with_mesh(collider, |Body { pose, world_from_model }| {
            Some(world_from_model.transform_point(pose.source_vertex(vertex)?).as_vec3())
        })
    }

    /// All vertices of a collider's mesh in its current pose, in world space and in the mesh's order. Blends the whole mesh.
    #[must_use]
    pub fn posed_vertices(&self, collider: Entity) -> Option<Vec<Vec3>> {
        self.with_mesh(collider, |Body { pose, world_from_model }| {
            let posed = (0..).map_while(|vertex| pose.source_vertex(vertex));
            Some(posed.map(|p| world_from_model.transform_point(p).as_vec3()).collect())
        })
    }

    /// The corners of a triangle of a collider's mesh in its current pose, in world space.
    #[must_use]
    pub fn posed_triangle(&self, collider: Entity, triangle: u32) -> Option<[Vec3; 3]> {
        self.with_mesh(collider, |mut body| Some(body.triangle(triangle)?.map(DVec3::as_vec3)))
    }
}
