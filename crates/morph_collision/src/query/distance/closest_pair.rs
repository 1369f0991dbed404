//! The closest points of two triangles of different bodies, or of one.

use glam::DVec3;

use crate::exact::{ClosestPoints, Triangle, closest_of_triangles};
use crate::query::rank::Rank;
use crate::query::triangle_pair::TrianglePair;

/// The closest points of two bodies' surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPair {
    /// The two triangles.
    pub triangles: TrianglePair,
    /// The point on the first body's triangle, in world space.
    pub point_a: DVec3,
    /// The point on the second body's triangle, in world space.
    pub point_b: DVec3,
    /// The distance, in world units. It is 0 if and only if the triangles share a point. Otherwise its error is a few `f64` roundings of
    /// the triangles' sizes and the distance.
    pub distance: f64,
}

impl ClosestPair {
    /// The closest points of two triangles, and the square of their distance.
    #[inline]
    pub(super) fn measure(triangles: TrianglePair, corners_a: &Triangle, corners_b: &Triangle) -> (Self, f64) {
        let ClosestPoints { on_a, on_b, squared } = closest_of_triangles(corners_a, corners_b);
        let pair = Self {
            triangles,
            point_a: on_a,
            point_b: on_b,
            distance: squared.sqrt(),
        };
        (pair, squared)
    }

    pub(super) fn rank(&self) -> Rank<TrianglePair> {
        Rank::new(self.distance, self.triangles)
    }
}
