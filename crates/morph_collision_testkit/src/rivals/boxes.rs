//! Boxes, one and eight at a time. A box of posed `f32` vertices is exact; boxes are widened only when they change
//! spaces.

use glam::{Vec3, Vec3A};
use morph_collision::Aabb;

pub(super) const LANES: usize = 8;

/// An axis-aligned box in model space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box3 {
    pub(super) min: Vec3A,
    pub(super) max: Vec3A,
}

impl Box3 {
    pub(super) const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
    };

    #[inline]
    pub(super) fn of(points: impl Iterator<Item = Vec3>) -> Self {
        points.fold(Self::EMPTY, |hull, point| {
            let point = Vec3A::from(point);
            Self {
                min: hull.min.min(point),
                max: hull.max.max(point),
            }
        })
    }

    #[inline]
    pub(super) fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    #[inline]
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (self.min.cmple(other.max) & other.min.cmple(self.max)).all()
    }

    pub(super) fn aabb(&self) -> Aabb {
        Aabb {
            min: self.min.into(),
            max: self.max.into(),
        }
    }

    /// Half the surface; 0 for the empty box.
    pub(super) fn half_area(&self) -> f32 {
        let size = (self.max - self.min).max(Vec3A::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

/// Eight boxes as structure of arrays; unused lanes are empty and overlap nothing.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Box8 {
    pub(super) min: [[f32; LANES]; 3],
    pub(super) max: [[f32; LANES]; 3],
}

impl Default for Box8 {
    fn default() -> Self {
        Self {
            min: [[f32::INFINITY; LANES]; 3],
            max: [[f32::NEG_INFINITY; LANES]; 3],
        }
    }
}

impl Box8 {
    #[inline]
    pub(super) fn get(&self, lane: usize) -> Box3 {
        Box3 {
            min: Vec3A::from_array(self.min.map(|row| row[lane])),
            max: Vec3A::from_array(self.max.map(|row| row[lane])),
        }
    }

    #[inline]
    pub(super) fn set(&mut self, lane: usize, one: &Box3) {
        for axis in 0..3 {
            self.min[axis][lane] = one.min[axis];
            self.max[axis][lane] = one.max[axis];
        }
    }

    /// The box around the first `len`.
    #[inline]
    pub(super) fn hull(&self, len: usize) -> Box3 {
        (0..len).fold(Box3::EMPTY, |hull, lane| hull.union(&self.get(lane)))
    }

    /// The lanes that share a point with a box, as a bit mask; touching counts.
    #[inline]
    pub(super) fn overlap_mask(&self, other: &Box3) -> u8 {
        let mut inside = [true; LANES];
        for axis in 0..3 {
            let (start, end) = (other.min[axis], other.max[axis]);
            for (lane, inside) in inside.iter_mut().enumerate() {
                *inside &= (self.min[axis][lane] <= end) & (start <= self.max[axis][lane]);
            }
        }
        inside
            .iter()
            .enumerate()
            .fold(0, |mask, (lane, &inside)| mask | u8::from(inside) << lane)
    }
}
