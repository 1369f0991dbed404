//! Eight boxes side by side.

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x8, mask32x8};
use glam::Vec3;

use super::{Aabb, LANES, Lanes};

/// Eight boxes as a structure of arrays: the children of a node, or the triangles of a patch.
///
/// The ends of boxes are blended like any other numbers: `base + sum a * slope`. Lanes without a child hold arbitrary numbers;
/// callers mask them out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub(crate) struct BoxLanes {
    pub(crate) min: [Lanes; 3],
    pub(crate) max: [Lanes; 3],
}

/// The lower and the upper corner of a box. The fourth numbers are padding.
pub(crate) type Corners = [[f32; 4]; 2];

impl BoxLanes {
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Aabb {
        // Cheaper than a bounds check for every row.
        let lane = lane % LANES;
        let corner = |[x, y, z]: &[Lanes; 3]| Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
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

    /// Sets all eight boxes from their corners.
    #[inline(always)]
    pub(crate) fn set_corners<S: Simd>(&mut self, simd: S, corners: &[Corners; LANES]) {
        for (end, rows) in [&mut self.min, &mut self.max].into_iter().enumerate() {
            for first in [0, LANES / 2] {
                let a = f32x4::from_slice(simd, &corners[first][end]);
                let b = f32x4::from_slice(simd, &corners[first + 1][end]);
                let c = f32x4::from_slice(simd, &corners[first + 2][end]);
                let d = f32x4::from_slice(simd, &corners[first + 3][end]);
                let (ac, bd) = (a.zip_low(c), b.zip_low(d));
                let (ac_high, bd_high) = (a.zip_high(c), b.zip_high(d));
                ac.zip_low(bd).store_slice(&mut rows[0].0[first..first + 4]);
                ac.zip_high(bd).store_slice(&mut rows[1].0[first..first + 4]);
                ac_high.zip_low(bd_high).store_slice(&mut rows[2].0[first..first + 4]);
            }
        }
    }

    /// Sets all eight boxes to the same box.
    pub(crate) fn set_all(&mut self, bounds: &Aabb) {
        (0..LANES).for_each(|lane| self.set(lane, bounds));
    }

    /// Sets all eight boxes.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, min: [f32x8<S>; 3], max: [f32x8<S>; 3]) {
        for axis in 0..3 {
            min[axis].store_slice(&mut self.min[axis].0);
            max[axis].store_slice(&mut self.max[axis].0);
        }
    }

    /// Grows all eight boxes by `by` on every side.
    #[inline(always)]
    pub(crate) fn widen<S: Simd>(&mut self, simd: S, by: f32) {
        for axis in 0..3 {
            self.min[axis].add(simd, -by);
            self.max[axis].add(simd, by);
        }
    }

    /// Sets `girths` to the sum of each box's edge lengths, times `scale`.
    #[inline(always)]
    pub(crate) fn girths<S: Simd>(&self, simd: S, scale: f32, girths: &mut Lanes) {
        let side = |axis: usize| self.max[axis].load(simd) - self.min[axis].load(simd);
        let sum = (side(0) + side(1) + side(2)) * f32x8::splat(simd, scale);
        sum.store_slice(&mut girths.0);
    }

    /// Sets `depths` to roughly how deep each box reaches into `other`. Deeper boxes are more likely to contain intersections.
    #[inline(always)]
    pub(crate) fn depths<S: Simd>(&self, simd: S, other: &Aabb, depths: &mut [f32; LANES]) {
        let mut depth = f32x8::splat(simd, f32::INFINITY);
        for axis in 0..3 {
            depth = depth.min(self.max[axis].load(simd) - f32x8::splat(simd, other.min[axis]));
            depth = depth.min(f32x8::splat(simd, other.max[axis]) - self.min[axis].load(simd));
        }
        depth.store_slice(depths);
    }

    /// The bit mask of the boxes that share a point with `other`; touching counts. Boxes with NaN overlap everything.
    #[inline(always)]
    pub(crate) fn overlap_mask<S: Simd>(&self, simd: S, other: &Aabb) -> u8 {
        let mut apart = mask32x8::splat(simd, false);
        for axis in 0..3 {
            apart |= self.min[axis].load(simd).simd_gt(f32x8::splat(simd, other.max[axis]));
            apart |= self.max[axis].load(simd).simd_lt(f32x8::splat(simd, other.min[axis]));
        }
        !(apart.to_bitmask() as u8)
    }

    /// The smallest box around the boxes in the first `lanes` lanes. `lanes` must be at least 1.
    #[inline(always)]
    pub(crate) fn hull<S: Simd>(&self, simd: S, lanes: usize) -> Aabb {
        const NUMBERS: Lanes = Lanes([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let is_used = NUMBERS.load(simd).simd_lt(f32x8::splat(simd, lanes as f32));
        let used = |row: &Lanes| is_used.select(row.load(simd), f32x8::splat(simd, row.0[0]));
        let ([a, b, c], [d, e, f]) = (&self.min, &self.max);
        Aabb {
            min: Vec3::new(used(a).reduce_min(), used(b).reduce_min(), used(c).reduce_min()),
            max: Vec3::new(used(d).reduce_max(), used(e).reduce_max(), used(f).reduce_max()),
        }
    }

    /// The smallest box around all eight boxes.
    #[inline(always)]
    pub(crate) fn hull_of_all<S: Simd>(&self, simd: S) -> Aabb {
        let ([a, b, c], [d, e, f]) = (&self.min, &self.max);
        let least = |row: &Lanes| row.load(simd).reduce_min();
        let most = |row: &Lanes| row.load(simd).reduce_max();
        Aabb {
            min: Vec3::new(least(a), least(b), least(c)),
            max: Vec3::new(most(d), most(e), most(f)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kernel;
    use crate::bounds::{BoxMap, Frame, with_simd};

    #[test]
    fn infinite_boxes_overlap_everything_after_a_map_with_zeros() {
        let map = BoxMap::new(&Frame {
            linear: glam::DMat3::IDENTITY,
            ..Frame::default()
        });
        let (mut boxes, mut mapped) = (BoxLanes::default(), BoxLanes::default());
        boxes.set(3, &Aabb::UNBOUNDED);
        let far = Aabb::from_points([Vec3::splat(1e30)]);
        for kernel in Kernel::available() {
            with_simd!(kernel.level, simd => map.as_ref().unwrap().all(simd, &boxes, &mut mapped));
            assert_eq!(
                with_simd!(kernel.level, simd => mapped.overlap_mask(simd, &far)),
                1 << 3
            );
        }
    }
}
