use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};
use glam::Vec3;

use super::{Aabb, LANES, Lanes};

/// Eight boxes side by side, as structure of arrays: the children of a node, or the triangles of a patch.
///
/// A box is a row of numbers that depend linearly on the points it is made from, so that boxes are blended as numbers:
/// `base + sum a * slope`. Lanes without a child hold zeros and are masked out by the caller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub(crate) struct BoxLanes {
    pub(crate) min: [Lanes; 3],
    pub(crate) max: [Lanes; 3],
}

impl BoxLanes {
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Aabb {
        // Cut off rather than checked for every row.
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

    /// Makes these the boxes between corners.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, min: [f32x8<S>; 3], max: [f32x8<S>; 3]) {
        for axis in 0..3 {
            min[axis].store_slice(&mut self.min[axis].0);
            max[axis].store_slice(&mut self.max[axis].0);
        }
    }

    /// `self += a * slopes` for `a >= 0`.
    #[inline(always)]
    pub(crate) fn add_scaled<S: Simd>(&mut self, simd: S, a: f32, slopes: &Self) {
        for axis in 0..3 {
            self.min[axis].add_scaled(simd, a, &slopes.min[axis]);
            self.max[axis].add_scaled(simd, a, &slopes.max[axis]);
        }
    }

    /// Adds the interval of a displacement, scaled by a weight of any sign: a negative one takes the lower end by the largest
    /// displacement and the upper end by the smallest.
    #[inline(always)]
    pub(crate) fn add_interval<S: Simd>(&mut self, simd: S, weight: f32, interval: &Self) {
        let (low, high) = if weight < 0.0 {
            (&interval.max, &interval.min)
        } else {
            (&interval.min, &interval.max)
        };
        for axis in 0..3 {
            self.min[axis].add_scaled(simd, weight, &low[axis]);
            self.max[axis].add_scaled(simd, weight, &high[axis]);
        }
    }

    /// Grows all eight by `by` on every side.
    #[inline(always)]
    pub(crate) fn widen<S: Simd>(&mut self, simd: S, by: f32) {
        for axis in 0..3 {
            self.min[axis].add(simd, -by);
            self.max[axis].add(simd, by);
        }
    }

    /// The smallest box around the corners of triangles side by side; every lane of `corners` holds a triangle.
    #[inline(always)]
    pub(crate) fn around<S: Simd>(simd: S, corners: &[[[Lanes; 3]; 3]]) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for axis in 0..3 {
            let mut low = f32x8::splat(simd, f32::INFINITY);
            let mut high = f32x8::splat(simd, f32::NEG_INFINITY);
            for corner in corners.as_flattened() {
                let along = corner[axis].load(simd);
                low = low.min(along);
                high = high.max(along);
            }
            let (mut lows, mut highs) = (Lanes::default(), Lanes::default());
            low.store_slice(&mut lows.0);
            high.store_slice(&mut highs.0);
            bounds.min[axis] = lows.least();
            bounds.max[axis] = highs.most();
        }
        bounds
    }

    /// How far each lane reaches into `other`, about: where intersections are the more likely the deeper.
    #[inline(always)]
    pub(crate) fn depths<S: Simd>(&self, simd: S, other: &Aabb, depths: &mut [f32; LANES]) {
        let mut depth = f32x8::splat(simd, f32::INFINITY);
        for axis in 0..3 {
            depth = depth.min(self.max[axis].load(simd) - f32x8::splat(simd, other.min[axis]));
            depth = depth.min(f32x8::splat(simd, other.max[axis]) - self.min[axis].load(simd));
        }
        depth.store_slice(depths);
    }

    /// The lanes that share a point with `other`, as a bit mask; touching counts.
    #[inline(always)]
    pub(crate) fn overlap_mask<S: Simd>(&self, simd: S, other: &Aabb) -> u8 {
        let mut overlap = mask32x8::splat(simd, true);
        for axis in 0..3 {
            overlap &= self.min[axis].load(simd).simd_le(f32x8::splat(simd, other.max[axis]));
            overlap &= self.max[axis].load(simd).simd_ge(f32x8::splat(simd, other.min[axis]));
        }
        overlap.to_bitmask() as u8
    }

    /// The smallest box around the lanes in a mask.
    pub(crate) fn hull(&self, lanes: u8) -> Aabb {
        (0..LANES)
            .filter(|lane| lanes >> lane & 1 == 1)
            .fold(Aabb::EMPTY, |hull, lane| hull.union(&self.get(lane)))
    }

    /// The smallest box around all eight.
    #[inline(always)]
    pub(crate) fn hull_of_all(&self) -> Aabb {
        let [min_x, min_y, min_z] = &self.min;
        let [max_x, max_y, max_z] = &self.max;
        Aabb {
            min: Vec3::new(min_x.least(), min_y.least(), min_z.least()),
            max: Vec3::new(max_x.most(), max_y.most(), max_z.most()),
        }
    }
}
