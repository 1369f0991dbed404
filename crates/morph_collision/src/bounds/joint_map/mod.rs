//! How a joint moves the points of a mesh, as seen from a frame, and the images of boxes under that map.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x4, mask32x8};
use glam::DVec3;

use super::{BoxLanes, LANES, WorldFromModel};
use crate::joints::Columns;

/// Half a unit in the last place of 1 in `f32`.
const U: f64 = f32::EPSILON as f64 / 2.0;
/// Maps with larger entries could overflow in sums.
const MAX_ENTRY: f32 = 1e37;
/// The relative drift allowed. If joints move only by the rounding of their `f32` matrices, the map moves by a few `U`.
const DRIFT: f64 = 4.0 * U;

/// An affine map from a mesh's space, before joints move it, to a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JointMap {
    /// Whether this is the identity, because the frame is the joint's own.
    pub(crate) is_identity: bool,
    /// The columns of the linear part and the translation, with a fourth coordinate of 0.
    columns: [[f32; 4]; 4],
    /// The absolute values of the linear part.
    sizes: [[f32; 4]; 3],
    /// The largest sum of absolute values in a row of the linear part.
    norm: f32,
    /// The largest absolute coordinate of the translation.
    shift: f32,
    /// The largest error of a mapped point. It covers the rounding to `f32`, and keeping the map while its joints hardly move.
    pub(crate) drift: f32,
}

/// A space in which joints are seen. The map from world space into it is `inverse (x - translation)`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MapFrame {
    inverse: [[f64; 4]; 3],
    translation: [f64; 4],
    /// The largest sum of absolute values in a row of the inverse.
    norm: f64,
}

impl MapFrame {
    /// The space of `world_from_model`, which must be invertible.
    pub(crate) fn new(world_from_model: &WorldFromModel) -> Self {
        let pad = |v: DVec3| [v.x, v.y, v.z, 0.0];
        let inverse = world_from_model.inverse_linear();
        Self {
            inverse: [inverse.x_axis, inverse.y_axis, inverse.z_axis].map(pad),
            translation: pad(world_from_model.translation()),
            norm: world_from_model.inverse_norm(),
        }
    }

    /// The columns of a joint's linear part and its translation, as seen in this frame.
    #[inline(always)]
    pub(crate) fn joint<S: Simd>(&self, simd: S, [x, y, z, offset]: &Columns) -> [f64x4<S>; 4] {
        let mut relative = [0.0; 4];
        (f64x4::from_slice(simd, offset) - f64x4::from_slice(simd, &self.translation)).store_slice(&mut relative);
        // Closures, as in `map`, are not inlined here.
        let offset = self.turn(simd, &relative);
        [self.turn(simd, x), self.turn(simd, y), self.turn(simd, z), offset]
    }

    /// The largest sum of absolute values in a row of the linear part of the map into this space.
    pub(crate) fn norm(&self) -> f64 {
        self.norm
    }

    /// The image of a vector under the linear part.
    #[inline(always)]
    fn turn<S: Simd>(&self, simd: S, vector: &[f64; 4]) -> f64x4<S> {
        let [x, y, z] = &self.inverse;
        let x = f64x4::from_slice(simd, x) * f64x4::splat(simd, vector[0]);
        let y = f64x4::from_slice(simd, y) * f64x4::splat(simd, vector[1]);
        let z = f64x4::from_slice(simd, z) * f64x4::splat(simd, vector[2]);
        (x + y) + z
    }
}

/// The lower and upper ends of eight boxes.
pub(crate) type Ends<S> = [[f32x8<S>; 3]; 2];

impl JointMap {
    pub(crate) const IDENTITY: Self = Self {
        is_identity: true,
        columns: [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0; 4],
        ],
        sizes: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        norm: 1.0,
        shift: 0.0,
        drift: 0.0,
    };

    /// Updates the map for a joint with these columns and a well-conditioned frame, for points with coordinates up to `reach`.
    ///
    /// If the current map is still right up to its drift, keeps it and returns false.
    #[inline(always)]
    pub(crate) fn update<S: Simd>(&mut self, simd: S, frame: &MapFrame, joint: &Columns, reach: f64) -> bool {
        let zero = f64x4::splat(simd, 0.0);
        let from = f64x4::from_slice(simd, &frame.translation);
        let offset = f64x4::from_slice(simd, &joint[3]);
        let mut relative = [0.0; 4];
        (offset - from).store_slice(&mut relative);
        let mut images = [frame.turn(simd, &relative); 4];
        let (mut row_sums, mut own_row_sums, mut moved) = (zero, zero, zero);
        for i in 0..3 {
            images[i] = frame.turn(simd, &joint[i]);
            row_sums += images[i].abs();
            own_row_sums += f64x4::from_slice(simd, &joint[i]).abs();
            moved += (images[i] - widened(simd, &self.columns[i])).abs();
        }
        let reaches = f64x4::splat(simd, reach);
        let world = (own_row_sums * reaches + offset.abs()) + from.abs();
        // The last term covers subnormal entries.
        let drift = DRIFT * frame.norm * largest(world) + reach * 1e-44;
        // Without this, a map computed while numbers were larger would stay loose.
        let is_sharp = f64::from(self.drift) <= 2.0 * drift + f64::from(f32::MIN_POSITIVE) * 2.0;
        let moved = moved * reaches + (images[3] - widened(simd, &self.columns[3])).abs();
        if !self.is_identity && is_sharp && largest(moved) <= f64::from(self.drift) {
            return false;
        }
        let mut columns = [[0.0; 4]; 4];
        for (column, image) in columns.iter_mut().zip(images) {
            image.store_slice(column);
        }
        let columns = columns.map(|column| column.map(|entry| entry as f32));
        let [x, y, z, _] = columns.map(|column| column.map(f32::abs));
        // Rounded up, because error bounds are computed from these.
        let up = |value: f64| (value * (1.0 + 4.0 * U)) as f32;
        *self = Self {
            is_identity: false,
            columns,
            sizes: [x, y, z],
            norm: up(largest(row_sums)),
            shift: up(largest(images[3].abs())),
            drift: up(drift) + f32::MIN_POSITIVE,
        };
        true
    }

    /// A bound on the mapped coordinates of points with coordinates up to `reach`; infinite if `f32` might not represent the map.
    #[inline(always)]
    pub(crate) fn reach(&self, reach: f32) -> f32 {
        if self.norm.max(self.shift) <= MAX_ENTRY {
            self.norm * reach + self.shift
        } else {
            f32::INFINITY
        }
    }

    /// The images of eight boxes, given by their centers and half sizes.
    #[inline(always)]
    pub(crate) fn image<S: Simd>(&self, simd: S, [center, half]: &Ends<S>) -> Ends<S> {
        let zero = [f32x8::splat(simd, 0.0); 3];
        let [mut low, mut high] = [zero; 2];
        for (i, (low, high)) in low.iter_mut().zip(&mut high).enumerate() {
            let [x, y, z, offset] = &self.columns;
            let (x, y) = (f32x8::splat(simd, x[i]), f32x8::splat(simd, y[i]));
            let (z, offset) = (f32x8::splat(simd, z[i]), f32x8::splat(simd, offset[i]));
            let middle = ((x * center[0] + y * center[1]) + z * center[2]) + offset;
            let [x, y, z] = &self.sizes;
            let (x, y, z) = (
                f32x8::splat(simd, x[i]),
                f32x8::splat(simd, y[i]),
                f32x8::splat(simd, z[i]),
            );
            let radius = (x * half[0] + y * half[1]) + z * half[2];
            (*low, *high) = (middle - radius, middle + radius);
        }
        [low, high]
    }
}

#[inline(always)]
fn widened<S: Simd>(simd: S, column: &[f32; 4]) -> f64x4<S> {
    f64x4::from_slice(simd, &column.map(f64::from))
}

/// The largest of the first three numbers.
#[inline(always)]
fn largest<S: Simd>(vector: f64x4<S>) -> f64 {
    let mut of = [0.0; 4];
    vector.store_slice(&mut of);
    // All numbers here are finite. A comparison takes one instruction, `f64::max` four.
    let of_two = if of[1] > of[0] { of[1] } else { of[0] };
    if of[2] > of_two { of[2] } else { of_two }
}

impl BoxLanes {
    /// Grows the boxes in the lanes of `mask` to contain the given boxes.
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

    /// Grows the box in `lane` to contain the box in lane `other` of `others`.
    #[inline(always)]
    pub(crate) fn join_one(&mut self, lane: usize, others: &Self, other: usize) {
        let (lane, other) = (lane % LANES, other % LANES);
        // Comparisons take one instruction, `f32::min` four. Both keep the old end if the new one is NaN.
        for axis in 0..3 {
            let (min, max) = (&mut self.min[axis].0[lane], &mut self.max[axis].0[lane]);
            let (low, high) = (others.min[axis].0[other], others.max[axis].0[other]);
            *min = if low < *min { low } else { *min };
            *max = if high > *max { high } else { *max };
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
