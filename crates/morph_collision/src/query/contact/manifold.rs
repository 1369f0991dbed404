use glam::DVec3;

use crate::query::TrianglePair;

/// A point common to two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// In world space; an end of the segment in which the two triangles meet.
    pub point: DVec3,
    /// How far the first triangle can be moved along the manifold's normal and still share a point with the second.
    pub depth: f64,
    /// The two triangles.
    pub pair: TrianglePair,
}

impl ContactPoint {
    const NONE: Self = Self {
        point: DVec3::ZERO,
        depth: 0.0,
        pair: TrianglePair {
            triangle_a: 0,
            triangle_b: 0,
        },
    };
}

/// What the contacts of two bodies come to: a direction, a depth and up to four points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manifold {
    /// The direction in which the first body leaves the second: the unit vector along the sum of the triangle pairs' normals,
    /// each weighted by the length of the pair's segment (all alike when every pair touches in a point).
    ///
    /// Where they cancel out it is the normal of the pair with the longest segment; zero if that has none either.
    pub normal: DVec3,
    /// The shortest way of the first body along the normal that parts every pair of triangles that intersects now, of those that
    /// were looked at.
    ///
    /// A lower bound of the way that parts the bodies, which may meet other triangles on it; for that see
    /// [`ContactQuery::separation`](crate::ContactQuery::separation).
    pub depth: f64,
    /// How many pairs of triangles intersect; if [`is_truncated`](Self::is_truncated), how many of them it was made from.
    pub pair_count: usize,
    /// Whether more pairs intersect than it was made from; see
    /// [`ContactQuery::manifold_up_to`](crate::ContactQuery::manifold_up_to). Normal, depth and points are then those of the pairs
    /// that were looked at.
    pub is_truncated: bool,
    points: [ContactPoint; 4],
    len: usize,
}

impl Manifold {
    /// At most four points of contact, the deepest first: then the one farthest from it, the one farthest from the line
    /// through both, and the one that adds most area on another side of the three. None is listed twice.
    #[must_use]
    pub fn points(&self) -> &[ContactPoint] {
        &self.points[..self.len]
    }

    /// `points` hold at least one, and their order decides between equals.
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
            points: [*deepest, ContactPoint::NONE, ContactPoint::NONE, ContactPoint::NONE],
            len: 1,
        };
        manifold.spread(points);
        Some(manifold)
    }

    fn spread(&mut self, points: &[ContactPoint]) {
        /// Points closer than this share of their coordinates, or of the others' extent, are one.
        const SAME: f64 = 1e-12;
        let p = self.points[0].point;
        let Some(second) = best(points, |c| c.point.distance_squared(p)) else {
            return;
        };
        let q = second.point;
        let extent = q.distance(p);
        if extent <= SAME * p.abs().max_element() {
            return;
        }
        self.add(second);

        let area = |c: &ContactPoint| (q - p).cross(c.point - p).length();
        let Some(third) = best(points, area).filter(|c| area(c) > SAME * extent * extent) else {
            return;
        };
        let r = third.point;
        self.add(third);

        let upright = (q - p).cross(r - p).normalize_or_zero();
        let outside = |c: &ContactPoint| {
            let mut farthest = 0.0;
            for (from, to) in [(p, q), (q, r), (r, p)] {
                let out = (c.point - from).cross(to - from).dot(upright);
                farthest = if out > farthest { out } else { farthest };
            }
            farthest
        };
        if let Some(fourth) = best(points, outside).filter(|c| outside(c) > SAME * extent * extent) {
            self.add(fourth);
        }
    }

    fn add(&mut self, point: &ContactPoint) {
        self.points[self.len] = *point;
        self.len += 1;
    }
}

/// The first with the largest value.
fn best(points: &[ContactPoint], value: impl Fn(&ContactPoint) -> f64) -> Option<&ContactPoint> {
    points.iter().rev().max_by(|p, q| value(p).total_cmp(&value(q)))
}
