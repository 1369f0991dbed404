//! Queries about two colliders: closest points and contacts.

use bevy::prelude::*;
use morph_collision::TrianglePair;

use super::points::checked_distance;
use super::target::{Target, with_target};
use super::{MorphClosestPoints, MorphManifold, MorphSpatialQuery};
use crate::contacts::{MorphContact, MorphContactPoint};

/// Stands for the triangle of a shape.
const NONE: u32 = MorphContact::NO_TRIANGLE;

impl MorphSpatialQuery<'_, '_> {
    /// The closest points of two colliders that are at most `max_distance` apart. `None` if they are farther apart or if one of
    /// them does not exist.
    ///
    /// Meshes are surfaces, shapes are solid. If the colliders touch, the distance is 0 and both points are somewhere where they
    /// do.
    #[must_use]
    pub fn closest_points(&self, a: Entity, b: Entity, max_distance: f32) -> Option<MorphClosestPoints> {
        let within = self.valid("closest_points", checked_distance(Vec3::ZERO, max_distance))?;
        let mut borrowed = self.borrow()?;
        let queries = borrowed.queries();
        let closest = self.with_both(a, b, |a, b| {
            Some(match (a, b) {
                (Target::Mesh(a), Target::Mesh(b)) => {
                    let closest = queries.distance.closest(a, b, within).ok()??;
                    (closest.point_a, closest.point_b, closest.distance, closest.triangles)
                }
                (Target::Mesh(a), Target::Shape(shape)) => {
                    let contact = queries.shape.closest(a, shape, within).ok()??;
                    let (on_mesh, on_shape) = (contact.point_on_triangle, contact.point_on_shape);
                    (on_mesh, on_shape, contact.distance, pair(contact.triangle, NONE))
                }
                (Target::Shape(shape), Target::Mesh(b)) => {
                    let contact = queries.shape.closest(b, shape, within).ok()??;
                    let (on_mesh, on_shape) = (contact.point_on_triangle, contact.point_on_shape);
                    (on_shape, on_mesh, contact.distance, pair(NONE, contact.triangle))
                }
                (Target::Shape(a), Target::Shape(b)) => {
                    let gap = a.gap(b);
                    (gap.distance <= within).then_some(())?;
                    (gap.point_a, gap.point_b, gap.distance, pair(NONE, NONE))
                }
            })
        });
        let (point1, point2, distance, triangles) = closest?;
        // Where the colliders touch, both points are the same.
        let point2 = if distance > 0.0 { point2 } else { point1 };
        Some(MorphClosestPoints {
            point1: point1.as_vec3(),
            point2: point2.as_vec3(),
            distance: distance.max(0.0) as f32,
            triangles,
        })
    }

    /// The contact points of two colliders. `None` if they do not touch, if one of them does not exist, or if both are shapes.
    ///
    /// Looks at no more than [`MorphCollisionSettings::max_triangle_pairs`](crate::components::MorphCollisionSettings) pairs of triangles.
    #[must_use]
    pub fn contacts(&self, a: Entity, b: Entity) -> Option<MorphManifold> {
        let limit = self.list_limit();
        let mut borrowed = self.borrow()?;
        let queries = borrowed.queries();
        self.with_both(a, b, |a, b| {
            let (mesh, shape, shape_first) = match (a, b) {
                (Target::Mesh(a), Target::Mesh(b)) => {
                    let manifold = queries.contact.manifold_up_to(a, b, limit);
                    return manifold.as_ref().map(MorphManifold::from);
                }
                (Target::Mesh(mesh), Target::Shape(shape)) => (mesh, shape, false),
                (Target::Shape(shape), Target::Mesh(mesh)) => (mesh, shape, true),
                (Target::Shape(_), Target::Shape(_)) => return None,
            };
            let mut met = Vec::new();
            let is_truncated = queries.shape.contacts_up_to(mesh, shape, 0.0, limit, &mut met).ok()?;
            let points = MorphContactPoint::with_shape(&mut met, shape_first);
            let deepest = met.first()?;
            // The direction out of the shape is the one in which the mesh separates.
            let turn = if shape_first { -1.0 } else { 1.0 };
            Some(MorphManifold {
                normal: (deepest.normal * turn).as_vec3(),
                depth: -deepest.distance as f32,
                pair_count: met.len(),
                is_truncated,
                points,
            })
        })
    }

    /// Calls `ask` with two colliders; `None` if one of them does not exist or both are the same.
    fn with_both<T>(&self, a: Entity, b: Entity, ask: impl FnOnce(Target<'_>, Target<'_>) -> Option<T>) -> Option<T> {
        let (state_a, state_b) = (self.state(a)?, self.state(b)?);
        // Always lock in the same order, so that two systems never wait for each other's second lock.
        match a.cmp(&b) {
            std::cmp::Ordering::Less => with_target(state_a, |a| with_target(state_b, |b| ask(a, b)))??,
            std::cmp::Ordering::Greater => with_target(state_b, |b| with_target(state_a, |a| ask(a, b)))??,
            std::cmp::Ordering::Equal => None,
        }
    }
}

fn pair(triangle_a: u32, triangle_b: u32) -> TrianglePair {
    TrianglePair { triangle_a, triangle_b }
}
