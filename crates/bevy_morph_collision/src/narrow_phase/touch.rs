//! Builds contacts from colliders that touch.

use bevy::prelude::*;
use morph_collision::{
    ContactQuery, DistanceQuery, PlacedShape, ShapeContact, ShapeQuery, TrianglePair, triangle_contact,
};

use super::{Asked, Placed};
use crate::collider::MorphCollisionMode;
use crate::contacts::{MorphContact, MorphContactPoint, pair_with_shape};
use crate::diagnostics::MorphCollisionDiagnostics;

/// The queries that build contacts.
#[derive(Default)]
pub(super) struct Touch {
    contact: ContactQuery,
    distance: DistanceQuery,
    shape: ShapeQuery,
}

/// The intersecting triangles of two meshes.
pub(super) struct Listed {
    pub(super) triangles: Vec<TrianglePair>,
    /// Whether there are more.
    pub(super) is_truncated: bool,
}

/// Whether a mode asks for every pair of triangles, up to a limit.
pub(super) fn wants_all(mode: MorphCollisionMode) -> bool {
    matches!(mode, MorphCollisionMode::All | MorphCollisionMode::Contacts)
}

impl Touch {
    /// The contact of two meshes, of which these triangles intersect.
    pub(super) fn with_mesh(
        &mut self,
        placed: &mut [Placed<'_>],
        asked: Asked,
        found: Listed,
        limit: usize,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) -> Option<MorphContact> {
        let Listed {
            mut triangles,
            is_truncated,
        } = found;
        let (a, b) = asked.places;
        let Ok([a, b]) = placed.get_disjoint_mut([a, b]) else {
            return None;
        };
        let margin = f64::from(a.placement.margin) + f64::from(b.placement.margin);
        let mut contact = MorphContact::of(asked, a, b);
        if triangles.is_empty() {
            if margin == 0.0 {
                return None;
            }
            let closest = self.distance.closest(a.body()?, b.body()?, margin).ok()?;
            diagnostics.stats += self.distance.stats();
            let closest = closest?;
            contact.point = closest.point_a.midpoint(closest.point_b).as_vec3();
            contact.normal = (closest.point_a - closest.point_b).normalize_or_zero().as_vec3();
            contact.distance = closest.distance as f32;
            return Some(contact);
        }
        contact.is_truncated = is_truncated;
        let first = triangles[0];
        let corners_a = a.body()?.triangle(first.triangle_a)?;
        let corners_b = b.body()?.triangle(first.triangle_b)?;
        if let Some(met) = triangle_contact(&corners_a, &corners_b) {
            contact.point = met.point().as_vec3();
            contact.normal = met.normal.as_vec3();
        }
        if asked.mode == MorphCollisionMode::Contacts {
            let manifold = self.contact.manifold_up_to(a.body()?, b.body()?, limit);
            diagnostics.stats += self.contact.stats();
            if let Some(manifold) = manifold {
                contact.normal = manifold.normal.as_vec3();
                contact
                    .points
                    .extend(manifold.points().iter().map(|point| MorphContactPoint {
                        point: point.point.as_vec3(),
                        depth: point.depth as f32,
                        triangles: point.pair,
                    }));
                contact.point = contact.points.first().map_or(contact.point, |deepest| deepest.point);
            }
        }
        if asked.mode != MorphCollisionMode::Any {
            triangles.sort_unstable();
            contact.triangles = triangles;
        }
        Some(contact)
    }

    /// The contact of a mesh and a shape.
    pub(super) fn with_shape(
        &mut self,
        placed: &mut [Placed<'_>],
        asked: Asked,
        (shape, shape_first): (&PlacedShape, bool),
        limit: usize,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) -> Option<MorphContact> {
        let (a, b) = asked.places;
        let Ok([a, b]) = placed.get_disjoint_mut([a, b]) else {
            return None;
        };
        let margin = f64::from(a.placement.margin) + f64::from(b.placement.margin);
        let mut contact = MorphContact::of(asked, a, b);
        let mesh = if shape_first { b } else { a };
        let pair = |triangle| pair_with_shape(triangle, shape_first);
        // The direction out of the shape is the one in which the mesh separates.
        let turn = if shape_first { -1.0 } else { 1.0 };
        let closest = self.shape.closest(mesh.body()?, shape, margin).ok()?;
        diagnostics.stats += self.shape.stats();
        let closest: ShapeContact = closest?;
        contact.point = closest.point_on_triangle.midpoint(closest.point_on_shape).as_vec3();
        contact.normal = (closest.normal * turn).as_vec3();
        contact.distance = closest.distance.max(0.0) as f32;
        let touches = closest.distance <= 0.0;
        if touches && asked.mode == MorphCollisionMode::First {
            contact.triangles.push(pair(closest.triangle));
        }
        if touches && wants_all(asked.mode) {
            let mut met = Vec::new();
            let is_truncated = self.shape.contacts_up_to(mesh.body()?, shape, 0.0, limit, &mut met);
            diagnostics.stats += self.shape.stats();
            contact.is_truncated = is_truncated.ok()?;
            contact.triangles = met.iter().map(|met| pair(met.triangle)).collect();
            contact.triangles.sort_unstable();
            if asked.mode == MorphCollisionMode::Contacts {
                contact.points = MorphContactPoint::with_shape(&mut met, shape_first);
            }
        }
        Some(contact)
    }
}

impl MorphContact {
    fn of(asked: Asked, a: &Placed<'_>, b: &Placed<'_>) -> Self {
        Self {
            collider1: asked.pair.0,
            collider2: asked.pair.1,
            body1: a.placement.body,
            body2: b.placement.body,
            mode: asked.mode,
            point: Vec3::ZERO,
            normal: Vec3::ZERO,
            distance: 0.0,
            triangles: Vec::new(),
            is_truncated: false,
            points: Vec::new(),
        }
    }
}
