use glam::{DMat3, DVec3};

use super::placed::PlacedShape;
use super::solid::Solid;
use crate::bounds::{Aabb, Box64, WorldFromModel};
use crate::exact::closest_on_segment;

/// Lower bounds for the signed distances of everything in a model-space box.
///
/// Any direction gives a bound: the gap along it between the shape and the box taken to world space. Tests the normals of the
/// box's faces, which are the same for every node, and the direction from the shape to the box's centre.
pub(super) struct NodeBound<'a> {
    shape: &'a PlacedShape,
    world_from_model: &'a WorldFromModel,
    faces: [FaceDirection; 3],
    /// Covers the rounding errors of a bound, of the vertices in world space, and of the distances computed in leaves.
    slack: f64,
}

/// A direction, and the shape's supports along it and against it.
#[derive(Clone, Copy, Debug)]
struct FaceDirection {
    direction: DVec3,
    supports: [f64; 2],
}

/// See [`NodeBound::slack`]: 64 roundings, each at most half an epsilon of all magnitudes that take part. More than the longest chain of
/// operations here has.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

impl<'a> NodeBound<'a> {
    /// For nodes inside `root`, the body's bounds in model space.
    pub(super) fn new(shape: &'a PlacedShape, world_from_model: &'a WorldFromModel, root: &Aabb) -> Self {
        let m = world_from_model.linear();
        let faces = [(m.y_axis, m.z_axis), (m.z_axis, m.x_axis), (m.x_axis, m.y_axis)].map(|(u, v)| {
            // Normalised first to avoid overflow. A flattened body has fewer faces; a zero direction bounds nothing.
            let direction = u.normalize_or_zero().cross(v.normalize_or_zero()).normalize_or_zero();
            FaceDirection {
                direction,
                supports: [shape.support(direction), shape.support(-direction)],
            }
        });
        let linear = DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
        let reach = linear * root.magnitude().as_dvec3() + world_from_model.translation().abs();
        let slack = ROUNDING * (reach.element_sum() + shape.reach());
        Self {
            shape,
            world_from_model,
            faces,
            slack,
        }
    }

    pub(super) fn lower_bound(&self, node: &Box64) -> f64 {
        let m = self.world_from_model.linear();
        let half = node.half;
        let center = m * node.center + self.world_from_model.translation();
        let radius_along = |w: DVec3| {
            (w.dot(m.x_axis) * half.x).abs() + (w.dot(m.y_axis) * half.y).abs() + (w.dot(m.z_axis) * half.z).abs()
        };
        let outward = self.shape.outward(center);
        let mut bound = outward.dot(center) - radius_along(outward) - self.shape.support(outward);
        for face in &self.faces {
            if face.direction != DVec3::ZERO {
                let (along, radius) = (face.direction.dot(center), radius_along(face.direction));
                bound = bound.max(along - radius - face.supports[0]);
                bound = bound.max(-along - radius - face.supports[1]);
            }
        }
        // Overflow culls nothing.
        if bound.is_nan() {
            f64::NEG_INFINITY
        } else {
            bound - self.slack
        }
    }
}

impl PlacedShape {
    /// The largest `direction . x` over the shape; may be infinite.
    fn support(&self, direction: DVec3) -> f64 {
        match &self.solid {
            Solid::Ball { center, radius } => direction.dot(*center) + radius,
            Solid::Capsule { axis, radius } => support_of(axis, direction) + radius,
            Solid::Cuboid(cuboid) => cuboid.support(direction),
            Solid::HalfSpace { point, normal } if direction == *normal => direction.dot(*point),
            Solid::HalfSpace { .. } => f64::INFINITY,
            Solid::Segment(segment) => support_of(segment, direction),
        }
    }

    /// The gradient of the signed distance at a point: a unit vector, an arbitrary one where the gradient does not exist.
    fn outward(&self, point: DVec3) -> DVec3 {
        let from = |axis| (point - closest_on_segment(point, axis)).normalize_or(DVec3::X);
        match &self.solid {
            Solid::Ball { center, .. } => from([*center; 2]),
            Solid::Capsule { axis, .. } => from(*axis),
            Solid::Cuboid(cuboid) => cuboid.outward(point),
            Solid::HalfSpace { normal, .. } => *normal,
            Solid::Segment(segment) => from(*segment),
        }
    }

    /// An upper bound for the coordinates that take part in a distance to the shape.
    fn reach(&self) -> f64 {
        let of = |p: DVec3| p.abs().max_element();
        match &self.solid {
            Solid::Ball { center, radius } => of(*center) + radius,
            Solid::Capsule { axis, radius } => of(axis[0]).max(of(axis[1])) + radius,
            Solid::Cuboid(cuboid) => cuboid.reach(),
            Solid::HalfSpace { point, .. } => of(*point),
            Solid::Segment(segment) => of(segment[0]).max(of(segment[1])),
        }
    }
}

fn support_of(segment: &[DVec3; 2], direction: DVec3) -> f64 {
    direction.dot(segment[0]).max(direction.dot(segment[1]))
}
