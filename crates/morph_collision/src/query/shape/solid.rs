use glam::DVec3;

use super::cuboid::Cuboid;
use super::placed::PlacedShape;
use crate::exact::{
    Segment, Triangle, closest_of_segment_and_triangle, closest_on_segment, closest_on_triangle, common_segment,
    unit_normal,
};

/// A shape in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Solid {
    /// A ball or a capsule: all points within a radius of a segment. A ball's segment is a point.
    Round {
        axis: Segment,
        radius: f64,
    },
    Cuboid(Cuboid),
    HalfSpace {
        point: DVec3,
        normal: DVec3,
    },
}

/// The point of a triangle with the smallest signed distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    pub(super) point: DVec3,
    /// The unit vector along which the signed distance grows.
    pub(super) normal: DVec3,
    pub(super) distance: f64,
}

impl PlacedShape {
    /// The signed distance of a point, in world units; negative inside.
    ///
    /// Inside a cuboid it is the distance to the nearest face.
    #[must_use]
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        match &self.solid {
            Solid::Round { axis, radius } => point.distance(closest_on_segment(point, *axis)) - radius,
            Solid::Cuboid(cuboid) => cuboid.signed_distance(point),
            Solid::HalfSpace { point: foot, normal } => (point - foot).dot(*normal),
        }
    }

    /// Whether a closed triangle in world space shares a point with the shape.
    ///
    /// Exact for a cuboid, the solid spanned by its eight `f64` corners and its `f64` centre, with each face split into two
    /// triangles; and for a capsule with length but no radius, the segment between its `f64` ends. For other shapes: whether the triangle's
    /// signed distance, computed in `f64`, is at most 0.
    #[must_use]
    pub fn intersects(&self, triangle: &Triangle) -> bool {
        match &self.solid {
            Solid::Cuboid(cuboid) => cuboid.intersects(triangle),
            _ => self.closest(triangle).distance <= 0.0,
        }
    }

    /// The point of a triangle with the smallest signed distance, which is at most 0 exactly if they intersect.
    pub(super) fn closest(&self, triangle: &Triangle) -> Closest {
        match &self.solid {
            Solid::Round { axis, radius } => {
                let closest = closest_to_axis(*axis, triangle);
                Closest {
                    distance: closest.distance - radius,
                    ..closest
                }
            }
            Solid::Cuboid(cuboid) => cuboid.closest(triangle),
            Solid::HalfSpace { point, normal } => {
                let height = |corner: &DVec3| (corner - point).dot(*normal);
                let lowest = triangle
                    .iter()
                    .min_by(|p, q| height(p).total_cmp(&height(q)))
                    .unwrap_or(&triangle[0]);
                Closest {
                    point: *lowest,
                    normal: *normal,
                    distance: height(lowest),
                }
            }
        }
    }
}

/// The closest point to a ball's centre or a capsule's segment. The distance to a segment is 0 exactly if they share a point.
fn closest_to_axis([p, q]: Segment, triangle: &Triangle) -> Closest {
    let apart = |on_axis: DVec3, point: DVec3, distance: f64| Closest {
        point,
        normal: (point - on_axis).try_normalize().unwrap_or(unit_normal(triangle)),
        distance,
    };
    if p == q {
        let foot = closest_on_triangle(p, triangle);
        return apart(p, foot.point, foot.squared.sqrt());
    }
    if let Some([s, t]) = common_segment(triangle, &[p, q, q]) {
        let point = s + (t - s) * 0.5;
        // Points away from the end of the segment that reaches farther through the triangle.
        let normal = unit_normal(triangle);
        let faces_middle = normal.dot(p - point + (q - point)) > 0.0;
        return Closest {
            point,
            normal: if faces_middle { -normal } else { normal },
            distance: 0.0,
        };
    }
    let closest = closest_of_segment_and_triangle([p, q], triangle);
    let distance = closest.on_a.distance(closest.on_b);
    apart(closest.on_a, closest.on_b, distance.max(f64::MIN_POSITIVE))
}
