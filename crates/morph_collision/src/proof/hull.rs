//! The point of a convex hull closest to the origin, from a few of the hull's points.

use glam::DVec3;

use crate::exact::closest_on_triangle;

/// Up to three points of a hull, and their closest point to the origin. Grows towards the hull's own closest point (Gilbert, Johnson,
/// Keerthi 1988).
#[derive(Clone, Copy, Debug)]
pub(super) struct ClosestOfHull {
    corners: [DVec3; 3],
    pub(super) point: DVec3,
}

impl ClosestOfHull {
    pub(super) fn new(point: DVec3) -> Self {
        Self {
            corners: [point; 3],
            point,
        }
    }

    /// Takes another point of the hull into account. Returns false if the closest point does not get closer, or if the origin is in the hull.
    pub(super) fn add(&mut self, point: DVec3) -> bool {
        let [a, b, c] = self.corners;
        if contains_origin([a, b, c, point]) {
            return false;
        }
        let before = self.point.length_squared();
        let mut squared = before;
        for corners in [[a, b, point], [b, c, point], [c, a, point]] {
            let closest = closest_on_triangle(DVec3::ZERO, &corners);
            if closest.squared < squared {
                squared = closest.squared;
                (self.corners, self.point) = (corners, closest.point);
            }
        }
        squared < before
    }
}

/// Whether the origin is in a tetrahedron: on the same side of each face as the corner opposite. Rounding can make it wrong.
fn contains_origin([a, b, c, d]: [DVec3; 4]) -> bool {
    [[a, b, c, d], [b, c, d, a], [c, d, a, b], [d, a, b, c]]
        .into_iter()
        .all(|[x, y, z, opposite]| {
            let normal = (y - x).cross(z - x);
            normal.dot(opposite - x) * normal.dot(-x) > 0.0
        })
}
