//! Eight boxes as structure of arrays: what one visit of a node blends and tests.

use glam::Vec3;

use super::Aabb;

/// Children of a node at most, and the width of every kernel.
pub(crate) const LANES: usize = 8;

/// One number of eight boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Lanes(pub(crate) [f32; LANES]);

impl Lanes {
    pub(crate) const fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    /// `self += a * x`, lane by lane, multiply then add.
    #[inline]
    pub(crate) fn add_scaled(&mut self, a: f32, x: &Self) {
        for (sum, x) in self.0.iter_mut().zip(&x.0) {
            *sum += a * x;
        }
    }

    #[inline]
    pub(crate) fn add(&mut self, value: f32) {
        for sum in &mut self.0 {
            *sum += value;
        }
    }
}

/// Eight boxes. Lanes without a child hold zeros and are masked out by the node's length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoxLanes {
    pub(crate) min: [Lanes; 3],
    pub(crate) max: [Lanes; 3],
}

impl BoxLanes {
    pub(crate) fn get(&self, lane: usize) -> Aabb {
        let corner = |rows: &[Lanes; 3]| Vec3::from_array(rows.map(|row| row.0[lane]));
        Aabb {
            min: corner(&self.min),
            max: corner(&self.max),
        }
    }

    pub(crate) fn set(&mut self, lane: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.min[axis].0[lane] = bounds.min[axis];
            self.max[axis].0[lane] = bounds.max[axis];
        }
    }

    /// The lanes whose boxes share a point with `other`, as a bit mask.
    #[inline]
    pub(crate) fn overlap_mask(&self, other: &Aabb) -> u8 {
        let mut mask = 0;
        for lane in 0..LANES {
            let mut overlap = true;
            for axis in 0..3 {
                overlap &= self.min[axis].0[lane] <= other.max[axis];
                overlap &= other.min[axis] <= self.max[axis].0[lane];
            }
            mask |= u8::from(overlap) << lane;
        }
        mask
    }
}
