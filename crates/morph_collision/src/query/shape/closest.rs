//! Where a triangle, or something else, is closest to a shape.

use glam::DVec3;

/// The point of a set with the smallest signed distance from a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    pub(super) point: DVec3,
    /// The unit vector along which the signed distance grows.
    pub(super) normal: DVec3,
    pub(super) distance: f64,
}

impl Closest {
    /// The same two closest points, with the shape's instead of the set's.
    pub(super) fn seen_from_the_other(self) -> Self {
        Self {
            point: self.point - self.normal * self.distance,
            normal: -self.normal,
            distance: self.distance,
        }
    }

    /// The same for everything within a radius of the set.
    pub(super) fn of_rounded_set(self, radius: f64) -> Self {
        Self {
            point: self.point - self.normal * radius,
            distance: self.distance - radius,
            ..self
        }
    }

    /// The same for everything within a radius of the shape.
    pub(super) fn seen_from_rounded_shape(self, radius: f64) -> Self {
        Self {
            distance: self.distance - radius,
            ..self
        }
    }

    /// The smallest of several, the first if there is more than one.
    pub(super) fn smallest(all: impl Iterator<Item = Self>) -> Option<Self> {
        all.min_by(|x, y| x.distance.total_cmp(&y.distance))
    }
}
