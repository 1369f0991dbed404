//! The summary of the contacts of two bodies.

use glam::DVec3;

use crate::exact::{edges, largest};
use crate::query::TrianglePair;

/// A point that two bodies share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// An end of the segment in which the two triangles meet, in world space.
    pub point: DVec3,
    /// How far the first triangle can move along the manifold's normal before it leaves the second, in world units.
    pub depth: f64,
    /// The two triangles.
    pub triangles: TrianglePair,
}

/// A summary of the contacts of two bodies: a normal, a depth and up to four points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manifold {
    /// The unit direction in which the first body leaves the second: the normalised sum of the triangle pairs' normals, each weighted by
    /// the length of the pair's segment. If all segments are points, the weights are equal.
    ///
    /// If the sum cancels out, this is the normal of the pair with the longest segment; zero if that pair has no normal.
    pub normal: DVec3,
    /// How far the first body must move along the normal to separate every pair of triangles that intersects now, in world units.
    ///
    /// This is a lower bound for separating the bodies: other triangles may meet on the way.
    pub depth: f64,
    /// The number of triangle pairs that the manifold summarises.
    pub pair_count: usize,
    /// Whether more pairs intersect than the limit of
    /// [`ContactQuery::manifold_up_to`](crate::ContactQuery::manifold_up_to) allowed.
    pub is_truncated: bool,
    points: [ContactPoint; 4],
    len: usize,
}

impl Manifold {
    /// Returns up to four distinct points: the deepest, the one farthest from it, the one farthest from the line through both, and
    /// the one that adds the most area to the triangle of the first three.
    #[must_use]
    pub fn points(&self) -> &[ContactPoint] {
        &self.points[..self.len]
    }

    /// The manifold of some points; `None` if there are none. Among equals, the first point wins.
    pub(super) fn reduce(
        normal: DVec3,
        pair_count: usize,
        is_truncated: bool,
        points: &[ContactPoint],
    ) -> Option<Self> {
        let deepest = best(points, |p| p.depth)?;
        let mut manifold = Self {
            normal,
            depth: deepest.depth,
            pair_count,
            is_truncated,
            points: [*deepest; 4],
            len: 1,
        };
        let _fewer_than_four = manifold.spread(points);
        Some(manifold)
    }

    /// Adds up to three points to the first. Returns early if the remaining points add nothing.
    fn spread(&mut self, points: &[ContactPoint]) -> Option<()> {
        /// Points closer together than this share of their coordinates, or of the extent so far, count as equal.
        const SAME: f64 = 1e-12;
        let p = self.points[0].point;
        let second = best(points, |c| c.point.distance_squared(p))?;
        let q = second.point;
        let extent = q.distance(p);
        if extent <= SAME * p.abs().max_element() {
            return None;
        }
        self.add(second);

        let area = |c: &ContactPoint| (q - p).cross(c.point - p).length();
        let third = best(points, area).filter(|c| area(c) > SAME * extent * extent)?;
        let r = third.point;
        self.add(third);

        let upright = (q - p).cross(r - p).normalize_or_zero();
        let outside = |c: &ContactPoint| {
            let beyond = |[from, to]: [DVec3; 2]| (c.point - from).cross(to - from).dot(upright);
            largest(edges(&[p, q, r]).map(beyond))
        };
        self.add(best(points, outside).filter(|c| outside(c) > SAME * extent * extent)?);
        Some(())
    }

    fn add(&mut self, point: &ContactPoint) {
        self.points[self.len] = *point;
        self.len += 1;
    }
}

/// The first point with the largest value.
fn best(points: &[ContactPoint], value: impl Fn(&ContactPoint) -> f64) -> Option<&ContactPoint> {
    points.iter().rev().max_by(|p, q| value(p).total_cmp(&value(q)))
}
