//! Builds contacts from colliders that touch.

use bevy::prelude::*;
use morph_collision::motion::MotionQuery;
use morph_collision::{
    ContactQuery, DistanceQuery, PlacedShape, QueryStats, ShapeContact, ShapeQuery, TrianglePair, triangle_contact,
};

use super::comparison::{BatchResult, Comparison, wants_all};
use super::participant::PlacedCollider;
use super::starts::RunView;
use crate::components::MorphCollisionMode;
use crate::contacts::{MorphContact, MorphContactPoint, pair_with_shape};
use crate::state::Form;

/// The queries that build contacts.
#[derive(Default)]
pub(super) struct ContactQueries {
    contact: ContactQuery,
    distance: DistanceQuery,
    shape: ShapeQuery,
    pub(super) motion: MotionQuery,
}

impl ContactQueries {
    /// The contact of two colliders; `None` if they do not touch. Takes the triangles that were found.
    pub(super) fn contact(
        &mut self,
        view: RunView<'_>,
        comparison: Comparison,
        known: &mut BatchResult,
        stats: &mut QueryStats,
    ) -> Option<MorphContact> {
        let (pair, limit) = (view.pair(comparison), view.limit);
        let empty = MorphContact::of(comparison, pair);
        match (known, &pair[0].placement.form, &pair[1].placement.form) {
            (
                BatchResult::Triangles {
                    triangles,
                    is_truncated,
                },
                ..,
            ) => {
                let contact = MorphContact {
                    is_truncated: *is_truncated,
                    ..empty
                };
                self.with_mesh(contact, pair, std::mem::take(triangles), limit, stats)
            }
            (BatchResult::NotAsked, _, Form::Shape(shape)) | (BatchResult::NotAsked, Form::Shape(shape), _) => {
                self.with_shape(empty, pair, shape, limit, stats)
            }
            (BatchResult::NotAsked, Form::Mesh(_), Form::Mesh(_)) | (BatchResult::Apart, ..) => None,
        }
    }

    /// The contact of two meshes, of which these triangles intersect.
    fn with_mesh(
        &mut self,
        mut contact: MorphContact,
        [a, b]: [&PlacedCollider<'_>; 2],
        mut triangles: Vec<TrianglePair>,
        limit: usize,
        stats: &mut QueryStats,
    ) -> Option<MorphContact> {
        // Each locks its pose: in ascending order, and never the same one twice.
        debug_assert!(a.entity < b.entity);
        let (mut mesh_a, mut mesh_b) = (a.mesh()?, b.mesh()?);
        if triangles.is_empty() {
            let margin = f64::from(a.placement.margin) + f64::from(b.placement.margin);
            if margin == 0.0 {
                return None;
            }
            let closest = self.distance.closest(mesh_a.body(), mesh_b.body(), margin).ok()?;
            *stats += self.distance.stats();
            let closest = closest?;
            contact.point = closest.point_a.midpoint(closest.point_b).as_vec3();
            contact.normal = (closest.point_a - closest.point_b).normalize_or_zero().as_vec3();
            contact.distance = closest.distance as f32;
            return Some(contact);
        }
        let first = triangles[0];
        let corners_a = mesh_a.body().triangle(first.triangle_a)?;
        let corners_b = mesh_b.body().triangle(first.triangle_b)?;
        if let Some(met) = triangle_contact(&corners_a, &corners_b) {
            contact.point = met.point().as_vec3();
            contact.normal = met.normal.as_vec3();
        }
        if contact.mode == MorphCollisionMode::Contacts {
            // PERF: finding all triangles a second time takes 10 % of a dense crowd's frame. A list that was cut may be another one than
            // the query finds, so the two are not mixed.
            let manifold = if contact.is_truncated {
                self.contact.manifold_up_to(mesh_a.body(), mesh_b.body(), limit)
            } else {
                self.contact.manifold_of(mesh_a.body(), mesh_b.body(), &triangles)
            };
            *stats += self.contact.stats();
            if let Some(manifold) = manifold {
                contact.normal = manifold.normal.as_vec3();
                contact
                    .points
                    .extend(manifold.points().iter().map(|point| MorphContactPoint {
                        point: point.point.as_vec3(),
                        depth: point.depth as f32,
                        triangles: point.triangles,
                    }));
                contact.point = contact.points.first().map_or(contact.point, |deepest| deepest.point);
            }
        }
        triangles.sort_unstable();
        contact.triangles = triangles;
        Some(contact)
    }

    /// The contact of a mesh and a shape.
    fn with_shape(
        &mut self,
        mut contact: MorphContact,
        [a, b]: [&PlacedCollider<'_>; 2],
        shape: &PlacedShape,
        limit: usize,
        stats: &mut QueryStats,
    ) -> Option<MorphContact> {
        let margin = f64::from(a.placement.margin) + f64::from(b.placement.margin);
        let shape_first = matches!(a.placement.form, Form::Shape(_));
        let mut mesh = if shape_first { b.mesh()? } else { a.mesh()? };
        let pair = |triangle| pair_with_shape(triangle, shape_first);
        // The direction out of the shape is the one in which the mesh separates.
        let turn = if shape_first { -1.0 } else { 1.0 };
        let closest = self.shape.closest(mesh.body(), shape, margin).ok()?;
        *stats += self.shape.stats();
        let closest: ShapeContact = closest?;
        contact.point = closest.point_on_triangle.midpoint(closest.point_on_shape).as_vec3();
        contact.normal = (closest.normal * turn).as_vec3();
        contact.distance = closest.distance.max(0.0) as f32;
        let touches = closest.distance <= 0.0;
        if touches && contact.mode == MorphCollisionMode::First {
            contact.triangles.push(pair(closest.triangle));
        }
        if touches && wants_all(contact.mode) {
            let mut met = Vec::new();
            let is_truncated = self.shape.contacts_up_to(mesh.body(), shape, 0.0, limit, &mut met);
            *stats += self.shape.stats();
            contact.is_truncated = is_truncated.ok()?;
            contact.triangles = met.iter().map(|met| pair(met.triangle)).collect();
            contact.triangles.sort_unstable();
            if contact.mode == MorphCollisionMode::Contacts {
                contact.points = MorphContactPoint::with_shape(&mut met, shape_first);
            }
        }
        Some(contact)
    }
}

impl MorphContact {
    /// The contact of a pair, still without points.
    pub(super) fn of(comparison: Comparison, [a, b]: [&PlacedCollider<'_>; 2]) -> Self {
        Self {
            collider1: comparison.pair.0,
            collider2: comparison.pair.1,
            body1: a.placement.body,
            body2: b.placement.body,
            mode: comparison.mode,
            point: Vec3::ZERO,
            normal: Vec3::ZERO,
            distance: 0.0,
            triangles: Vec::new(),
            is_truncated: false,
            points: Vec::new(),
            impact: None,
        }
    }
}
