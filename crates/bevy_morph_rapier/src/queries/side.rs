//! Keeps contacts from pushing a body through a thin surface, or aside.

use bevy_rapier3d::parry::math::{Pose, Real};
use bevy_rapier3d::parry::query::{ContactManifold, DefaultQueryDispatcher, QueryDispatcher};
use bevy_rapier3d::parry::shape::Shape;

use bevy_morph_physics::shape::{Patch, Triangles};

/// Removes contacts between a part of a surface and a convex shape that push the middle of the shape towards the surface.
///
/// Parry moves a shape out of each triangle along the shortest way. If a thin shape reaches through the surface, that may be
/// through the surface for some triangles and back for others, so that the shape is stuck in between. A contact of a convex shape
/// that reaches less far never pushes its middle towards the surface.
pub(crate) fn keep_side<ManifoldData, ContactData>(
    pos12: &Pose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    manifolds: &mut [ContactManifold<ManifoldData, ContactData>],
) {
    let parts = [g1, g2].map(|shape| shape.as_shape::<Patch>());
    let is_first = parts[0].is_some();
    let (patch, shape, in_patch) = match parts {
        [Some(patch), None] => (patch, g2, *pos12),
        [None, Some(patch)] => (patch, g1, pos12.inverse()),
        _ => return,
    };
    if shape.as_support_map().is_none() {
        return;
    }
    // The mean of the corners, for a polyhedron; inside any convex shape.
    let middle = in_patch.transform_point(shape.compute_local_bounding_sphere().center());
    for manifold in manifolds {
        let number = if is_first {
            manifold.subshape1
        } else {
            manifold.subshape2
        };
        if manifold.points.is_empty() || !patch.triangles.pushes_both_ways(number) {
            continue;
        }
        let normal = if is_first { manifold.local_n1 } else { manifold.local_n2 };
        manifold.points.retain(|contact| {
            let on_surface = if is_first { contact.local_p1 } else { contact.local_p2 };
            normal.dot(middle - on_surface) >= 0.0
        });
    }
}

/// Removes contacts between triangles and a convex shape that are much deeper than the two really overlap.
///
/// Parry turns contact normals into the range that a triangle allows, and then measures the depth along the new normal. The floor
/// below a vertical side would be as deep in that side as it is wide. Parry removes such contacts itself (`dist * 5.0` in its
/// manifolds), except of shapes that only touch.
pub(crate) fn keep_plausible<ManifoldData, ContactData>(
    pos12: &Pose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    prediction: Real,
    manifolds: &mut [ContactManifold<ManifoldData, ContactData>],
) {
    let (triangles, shape, in_triangles, is_first) = match [g1, g2].map(triangles_of) {
        [Some(triangles), None] => (triangles, g2, *pos12, true),
        [None, Some(triangles)] => (triangles, g1, pos12.inverse(), false),
        _ => return,
    };
    if shape.as_support_map().is_none() {
        return;
    }
    for manifold in manifolds {
        let deepest = manifold.points.iter().map(|contact| contact.dist).fold(0.0, Real::min);
        if deepest > -5.0 * prediction {
            continue;
        }
        let number = match is_first {
            true => manifold.subshape1,
            false => manifold.subshape2,
        };
        let Some(triangle) = triangles.triangle(number) else {
            continue;
        };
        let contact = DefaultQueryDispatcher.contact(&in_triangles, triangle, shape, prediction);
        let Ok(contact) = contact else { continue };
        let overlap = contact.map_or(0.0, |contact| (-contact.dist).max(0.0));
        let deepest = -5.0 * overlap.max(prediction);
        manifold.points.retain(|contact| contact.dist >= deepest);
    }
}

fn triangles_of(shape: &dyn Shape) -> Option<&Triangles> {
    let patch = shape.as_shape::<Patch>().map(|patch| &patch.triangles);
    patch.or_else(|| shape.as_shape::<Triangles>())
}
