//! The core of balls and capsules.

use glam::DVec3;

use super::super::closest::Closest;
use crate::exact::{
    Segment, Triangle, closest_of_segment_and_triangle, closest_on_triangle_exactly, common_segment, unit_normal,
};

/// The point of a triangle that is closest to a segment, or to a point twice. The distance is 0 if and only if they share a point.
pub(super) fn closest_to_segment([p, q]: Segment, triangle: &Triangle) -> Closest {
    let apart = |on_axis: DVec3, point: DVec3, distance: f64| Closest {
        point,
        normal: (point - on_axis).try_normalize().unwrap_or(unit_normal(triangle)),
        distance,
    };
    if p == q {
        let foot = closest_on_triangle_exactly(p, triangle);
        return apart(p, foot.point, foot.squared.sqrt());
    }
    if let Some([s, t]) = common_segment(triangle, &[p, q, q]) {
        let point = s + (t - s) * 0.5;
        // The normal points away from the end of the segment that reaches farther through the triangle.
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
