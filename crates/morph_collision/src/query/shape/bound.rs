//! Lower bounds of signed distances for nodes.

use glam::DVec3;

use super::solid::Solid;
use crate::bounds::{Box64, DistanceCull, PlacedBounds};
use crate::exact::Segment;
use crate::query::Body;

/// Lower bounds of distances from a point, a ball or a capsule.
pub(super) fn distance_cull(body: &mut Body<'_>, axis: Segment, radius: f64) -> DistanceCull {
    let tree = &mut body.posed();
    let corner_error = tree.corner_error();
    DistanceCull::new(axis, radius, &tree.placed_body().placed, corner_error)
}

/// Lower bounds for the signed distances of everything in a model-space box.
///
/// Any direction gives a bound: the gap along it between the shape and the box taken to world space. The directions tried are the
/// normals of the box's faces, which are the same for every node, and the direction from the shape to the box's centre.
pub(super) struct NodeBound<'a> {
    solid: &'a Solid,
    body: PlacedBounds,
    /// The unit normals of a box's faces, with the shape's supports along and against each. A normal is zero if the body is flattened.
    faces: [(DVec3, [f64; 2]); 3],
    /// Covers the rounding errors of a bound, of the vertices in world space, and of the distances computed in leaves.
    slack: f64,
}

/// The slack relative to the sum of all magnitudes: 64 roundings, more than the longest chain of operations here.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

impl<'a> NodeBound<'a> {
    /// Creates the bounds for nodes inside the bounds of `body`.
    pub(super) fn new(solid: &'a Solid, body: PlacedBounds) -> Self {
        let m = body.world_from_model().linear();
        let faces = [(m.y_axis, m.z_axis), (m.z_axis, m.x_axis), (m.x_axis, m.y_axis)].map(|(u, v)| {
            // Normalise first, to avoid overflow.
            let direction = u.normalize_or_zero().cross(v.normalize_or_zero()).normalize_or_zero();
            (direction, [solid.support(direction), solid.support(-direction)])
        });
        let body_reach = body.world_reach().element_sum();
        let slack = ROUNDING * (body_reach + solid.reach()) + 3.0 * body.error() + solid.blind_gap(body_reach);
        Self {
            solid,
            body,
            faces,
            slack,
        }
    }

    pub(super) fn lower_bound(&self, node: &Box64) -> f64 {
        let world_from_model = self.body.world_from_model();
        let m = world_from_model.linear();
        let half = node.half;
        let center = m * node.center + world_from_model.translation();
        let radius_along = |w: DVec3| {
            (w.dot(m.x_axis) * half.x).abs() + (w.dot(m.y_axis) * half.y).abs() + (w.dot(m.z_axis) * half.z).abs()
        };
        let outward = self.solid.outward(center);
        let mut bound = outward.dot(center) - radius_along(outward) - self.solid.support(outward);
        // A zero direction gives no bound.
        for (direction, supports) in self.faces.iter().filter(|(direction, _)| *direction != DVec3::ZERO) {
            let (along, radius) = (direction.dot(center), radius_along(*direction));
            bound = bound
                .max(along - radius - supports[0])
                .max(-along - radius - supports[1]);
        }
        let bound = bound - self.slack;
        // After an overflow, cull nothing.
        if bound.is_nan() { f64::NEG_INFINITY } else { bound }
    }
}
