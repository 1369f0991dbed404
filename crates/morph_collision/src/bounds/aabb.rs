//! Axis-aligned boxes in `f32`.

use glam::Vec3;

/// A closed axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub min: Vec3,
    /// The largest coordinates.
    pub max: Vec3,
}

impl Default for Aabb {
    /// [`Aabb::EMPTY`].
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The empty box: the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// All of space.
    pub(crate) const UNBOUNDED: Self = Self {
        min: Vec3::NEG_INFINITY,
        max: Vec3::INFINITY,
    };

    /// The smallest box around the points; [`Aabb::EMPTY`] if there are none.
    #[must_use]
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        let boxes = points.into_iter().map(|p| Self { min: p, max: p });
        boxes.fold(Self::EMPTY, |hull, one| hull.union(&one))
    }

    /// The smallest box around both boxes.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// What both boxes contain. They must overlap.
    #[inline]
    pub(crate) fn intersection(&self, other: &Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// Whether the boxes share a point; touching counts.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Whether a point is in the box or on its surface.
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// The center of the box.
    #[must_use]
    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The edge lengths.
    #[must_use]
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }

    /// The sum of the edge lengths, used to compare the sizes of boxes.
    #[inline]
    pub(crate) fn girth(&self) -> f32 {
        self.size().element_sum()
    }

    /// The largest absolute coordinate along each axis.
    pub(crate) fn magnitude(&self) -> Vec3 {
        self.min.abs().max(self.max.abs())
    }
}
