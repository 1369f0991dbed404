//! Boxes in `f64`.

use glam::{DVec3, Vec3};

use super::{Aabb, down, up};

/// A closed box in `f64`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) min: DVec3,
    pub(crate) max: DVec3,
}

impl Extent {
    /// The neutral element of [`Extent::union`].
    pub(crate) const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    pub(crate) fn point(point: DVec3) -> Self {
        Self { min: point, max: point }
    }

    #[inline]
    pub(crate) fn of_triangle([a, b, c]: &[DVec3; 3]) -> Self {
        Self {
            min: a.min(*b).min(*c),
            max: a.max(*b).max(*c),
        }
    }

    /// A box enlarged by a length to all sides.
    pub(crate) fn around(of: &Aabb, by: f64) -> Self {
        Self {
            min: of.min.as_dvec3() - by,
            max: of.max.as_dvec3() + by,
        }
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The smallest `f32` box around this one.
    pub(crate) fn outward(&self) -> Aabb {
        Aabb {
            min: Vec3::from_array(self.min.to_array().map(down)),
            max: Vec3::from_array(self.max.to_array().map(up)),
        }
    }

    /// The squared distance between two boxes, up to a few roundings; 0 if they overlap.
    #[inline]
    pub(crate) fn squared_distance(&self, other: &Self) -> f64 {
        let gap = (self.min - other.max).max(other.min - self.max).max(DVec3::ZERO);
        gap.length_squared()
    }
}
