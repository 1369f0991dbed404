//! How a box stands to exact points: what the tests of the error bounds measure.

use glam::Vec3;
use morph_collision_testkit::oracle::Dyadic;

use super::{Aabb, BoxMap};

/// An exact point.
pub(crate) type ExactPoint = [Dyadic; 3];

/// Where a map should have taken a point, times a determinant, and how far beside it a body's point may lie.
#[derive(Debug)]
pub(crate) struct Image {
    /// Positive.
    pub(crate) determinant: Dyadic,
    pub(crate) scaled: ExactPoint,
    /// Rows of a matrix, times the determinant, and the largest coordinates of the vector that it takes to an offset.
    pub(crate) scaled_offset: ([ExactPoint; 3], ExactPoint),
}

impl Image {
    /// How far an offset may reach along an axis, times the determinant.
    fn offset_along(&self, axis: usize) -> Dyadic {
        let (rows, reach) = &self.scaled_offset;
        (0..3)
            .map(|column| rows[axis][column].clone().abs() * reach[column].clone())
            .sum()
    }
}

/// The box of one point.
pub(crate) fn box_at(point: Vec3) -> Aabb {
    Aabb { min: point, max: point }
}

/// Whether a point lies in a box or on its faces, exactly.
pub(crate) fn holds(bounds: &Aabb, point: &ExactPoint) -> bool {
    (0..3).all(|i| Dyadic::from(bounds.min[i]) <= point[i] && point[i] <= Dyadic::from(bounds.max[i]))
}

/// The least by which a box must be widened to hold a point; negative for a point inside.
pub(crate) fn lack(bounds: &Aabb, point: &ExactPoint) -> f64 {
    let beyond = |i: usize| {
        let below = Dyadic::from(bounds.min[i]) - point[i].clone();
        below.max(point[i].clone() - Dyadic::from(bounds.max[i])).to_f64()
    };
    (0..3).map(beyond).fold(f64::NEG_INFINITY, f64::max)
}

/// The share of a map's slack that is needed for the mapped box of a point to hold its image.
pub(crate) fn slack_used(map: &BoxMap, point: &Aabb, image: &Image) -> f64 {
    let mapped = map.one(point);
    let used = |i: usize| {
        let (along, offset) = (image.scaled[i].clone(), image.offset_along(i));
        let end = |end: f32| Dyadic::from(end) * image.determinant.clone();
        let room_below = along.clone() - offset.clone() - end(mapped.min[i]);
        let room = room_below.min(end(mapped.max[i]) - along - offset);
        let twice_slack = Dyadic::from(map.offset_max[i]) - Dyadic::from(map.offset_min[i]);
        1.0 - 2.0 * room.ratio(&(twice_slack * image.determinant.clone()))
    };
    (0..3).map(used).fold(f64::NEG_INFINITY, f64::max)
}
