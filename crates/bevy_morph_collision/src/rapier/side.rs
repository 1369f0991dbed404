//! Keeps contacts from pushing a body through a thin surface.

use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::ContactManifold;
use bevy_rapier3d::parry::shape::Shape;

use crate::physics::triangles::Patch;

/// Removes contacts between a part of a surface and a convex shape that push the middle of the shape towards the surface.
///
/// Parry moves a shape out of each triangle along the shortest way. If a thin shape reaches through the surface, that may be
/// through the surface for some triangles and back for others, so that the shape is stuck in between. A contact of a convex shape
/// that reaches less far never pushes its middle towards the surface.
pub(super) fn keep_side<ManifoldData, ContactData>(
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
