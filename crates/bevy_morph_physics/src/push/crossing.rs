//! Where a moving point passes through a moving triangle.

use bevy::math::DVec3;
use morph_collision::motion::MovingPoint;

/// Where a point passes through a triangle.
pub(super) struct Crossing {
    pub(super) time: f64,
    /// The point of the triangle at the end of the step, and the normal on the side from which the point came.
    pub(super) now: [DVec3; 2],
}

impl Crossing {
    /// `None` if the point may pass, because it leaves a solid surface, or does not move relative to the triangle.
    pub(super) fn of(way: MovingPoint, face: [MovingPoint; 3], time: f64, outward: Option<f64>) -> Option<Self> {
        let at = |point: MovingPoint| point.start.lerp(point.end, time);
        let [a, b, c] = face.map(at);
        let point = at(way);
        let normal = (b - a).cross(c - a);
        let square = normal.length_squared();
        let weights = [(b, c), (c, a), (a, b)].map(|(from, to)| (from - point).cross(to - point).dot(normal) / square);
        let blend =
            |points: [DVec3; 3]| -> DVec3 { points.iter().zip(weights).map(|(point, weight)| point * weight).sum() };
        let comes = (way.end - way.start) - blend(face.map(|corner| corner.end - corner.start));
        // The side from which it comes, by the triangle's winding.
        let side = -comes.dot(normal).signum();
        if comes.dot(normal) == 0.0 || outward.is_some_and(|outward| outward != side) {
            return None;
        }
        let [a, b, c] = face.map(|corner| corner.end);
        let normal = (b - a).cross(c - a).try_normalize()? * side;
        let now = [blend([a, b, c]), normal];
        now.iter()
            .all(|vector| vector.is_finite())
            .then_some(Self { time, now })
    }
}

/// Whether the boxes around the ways of a point and a triangle overlap.
pub(super) fn may_meet(way: MovingPoint, face: [MovingPoint; 3]) -> bool {
    let corners = face.map(|corner| [corner.start, corner.end]);
    let min = corners.as_flattened().iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let max = corners
        .as_flattened()
        .iter()
        .copied()
        .fold(DVec3::NEG_INFINITY, DVec3::max);
    way.start.min(way.end).cmple(max).all() && way.start.max(way.end).cmpge(min).all()
}
