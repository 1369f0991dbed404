//! What a joint does to the points of a mesh, as seen from a frame, and the images of boxes under it.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};
use glam::{DMat3, DVec3};

use super::{BoxLanes, LANES, WorldFromModel};

/// Half a unit in the last place of 1 in `f32`.
const U: f64 = f32::EPSILON as f64 / 2.0;
/// Maps with larger entries could overflow in sums.
const MAX_ENTRY: f32 = 1e37;
/// A map whose joints move by the rounding of their `f32` matrices moves by a few of these.
const DRIFT: f64 = 4.0 * U;

/// An affine map from a mesh's space, before joints move it, to a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JointMap {
    /// Whether it changes nothing: the frame is the joint's own.
    pub(crate) is_identity: bool,
    /// Rows of the linear part.
    rows: [[f32; 3]; 3],
    /// Their absolute values.
    sizes: [[f32; 3]; 3],
    translation: [f32; 3],
    /// The largest sum of the absolute values in a row, and the largest absolute coordinate of the translation.
    norm: f32,
    shift: f32,
    /// How far off it may take a point: by its rounding to `f32`, and as it is kept when its joints hardly move.
    pub(crate) drift: f32,
}

/// The lower and upper ends of eight boxes.
pub(crate) type Ends<S> = [[f32x8<S>; 3]; 2];

impl JointMap {
    pub(crate) const IDENTITY: Self = Self {
        is_identity: true,
        rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        sizes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
        norm: 1.0,
        shift: 0.0,
        drift: 0.0,
    };

    /// Becomes the map of a joint with these columns to a frame, which must be well conditioned, for points with coordinates up to `reach`. Stays
    /// as it is, and returns false, if it is right up to its drift.
    pub(crate) fn follow(&mut self, frame: &WorldFromModel, joint: &[DVec3; 4], reach: f64) -> bool {
        let &[x, y, z, offset] = joint;
        let inverse = frame.inverse_linear();
        let linear = inverse * DMat3::from_cols(x, y, z);
        let translation = inverse * (offset - frame.translation());
        let world = (x.abs() + y.abs() + z.abs()) * reach + offset.abs() + frame.translation().abs();
        // The last term covers entries that are subnormal.
        let drift = DRIFT * frame.inverse_norm() * world.max_element() + reach * 1e-44;
        // A map from where numbers were larger would stay loose.
        let is_sharp = f64::from(self.drift) <= 2.0 * drift + f64::from(f32::MIN_POSITIVE) * 2.0;
        if !self.is_identity && is_sharp && self.is_near(&linear, translation, reach) {
            return false;
        }
        let row = |i: usize| linear.row(i).as_vec3().to_array();
        let rows = [row(0), row(1), row(2)];
        // Rounded up, for the error bound of what is computed from them.
        let up = |value: f64| (value * (1.0 + 4.0 * U)) as f32;
        *self = Self {
            is_identity: false,
            rows,
            sizes: rows.map(|row| row.map(f32::abs)),
            translation: translation.as_vec3().to_array(),
            norm: up((linear.abs() * DVec3::ONE).max_element()),
            shift: up(translation.abs().max_element()),
            drift: up(drift) + f32::MIN_POSITIVE,
        };
        true
    }

    fn is_near(&self, linear: &DMat3, translation: DVec3, reach: f64) -> bool {
        let [x, y, z] = self.rows.map(|row| DVec3::from_array(row.map(f64::from)));
        let moved = (*linear - DMat3::from_cols(x, y, z).transpose()).abs() * DVec3::splat(reach);
        let shifted = (translation - DVec3::from_array(self.translation.map(f64::from))).abs();
        (moved + shifted).max_element() <= f64::from(self.drift)
    }

    /// A bound on the coordinates of images of points with coordinates up to `reach`; infinite where `f32` may not hold the map.
    #[inline(always)]
    pub(crate) fn reach(&self, reach: f32) -> f32 {
        if self.norm.max(self.shift) <= MAX_ENTRY {
            self.norm * reach + self.shift
        } else {
            f32::INFINITY
        }
    }

    /// The images of eight boxes, given by their centres and half sizes.
    #[inline(always)]
    pub(crate) fn image<S: Simd>(&self, simd: S, [center, half]: &Ends<S>) -> Ends<S> {
        let zero = [f32x8::splat(simd, 0.0); 3];
        let [mut low, mut high] = [zero; 2];
        for (i, (low, high)) in low.iter_mut().zip(&mut high).enumerate() {
            let [x, y, z] = self.rows[i].map(|entry| f32x8::splat(simd, entry));
            let middle = ((x * center[0] + y * center[1]) + z * center[2]) + f32x8::splat(simd, self.translation[i]);
            let [x, y, z] = self.sizes[i].map(|entry| f32x8::splat(simd, entry));
            let radius = (x * half[0] + y * half[1]) + z * half[2];
            (*low, *high) = (middle - radius, middle + radius);
        }
        [low, high]
    }
}

impl BoxLanes {
    /// Grows the boxes in the lanes of a mask to hold others.
    #[inline(always)]
    pub(crate) fn join<S: Simd>(&mut self, simd: S, [low, high]: Ends<S>, mask: u8) {
        let is_used = mask32x8::from_bitmask(simd, u64::from(mask));
        for axis in 0..3 {
            let (min, max) = (self.min[axis].load(simd), self.max[axis].load(simd));
            is_used
                .select(min.min(low[axis]), min)
                .store_slice(&mut self.min[axis].0);
            is_used
                .select(max.max(high[axis]), max)
                .store_slice(&mut self.max[axis].0);
        }
    }

    /// Grows the box in a lane to hold that in a lane of others.
    #[inline(always)]
    pub(crate) fn join_one(&mut self, lane: usize, others: &Self, other: usize) {
        let (lane, other) = (lane % LANES, other % LANES);
        for axis in 0..3 {
            self.min[axis].0[lane] = self.min[axis].0[lane].min(others.min[axis].0[other]);
            self.max[axis].0[lane] = self.max[axis].0[lane].max(others.max[axis].0[other]);
        }
    }

    /// Both ends of all eight boxes.
    #[inline(always)]
    pub(crate) fn ends<S: Simd>(&self, simd: S) -> Ends<S> {
        [self.min, self.max].map(|[x, y, z]| [x.load(simd), y.load(simd), z.load(simd)])
    }
}

#[cfg(test)]
mod rounding_tests;
