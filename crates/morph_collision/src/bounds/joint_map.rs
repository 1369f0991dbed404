//! What a joint does to the points of a mesh, as seen from a frame, and the images of boxes under it.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};
use glam::{DMat3, DVec3};

use super::{BoxLanes, LANES, WorldFromModel};

/// Half a unit in the last place of 1 in `f32`.
const U: f64 = f32::EPSILON as f64 / 2.0;
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

    /// The map of a joint with these columns to a frame, which must be well conditioned, for points with coordinates up to `reach`.
    pub(crate) fn new(frame: &WorldFromModel, joint: &[DVec3; 4], reach: f64) -> Self {
        let (linear, translation) = in_frame(frame, joint);
        let row = |i: usize| linear.row(i).as_vec3().to_array();
        let rows = [row(0), row(1), row(2)];
        let row_sums = linear.abs() * DVec3::ONE;
        // Rounded up, for the error bound of what is computed from them.
        let up = |value: f64| (value * (1.0 + 4.0 * U)) as f32;
        let noise = frame.inverse_norm()
            * (world_norm(joint) * reach + translation_norm(joint) + frame.translation().abs().max_element());
        Self {
            is_identity: false,
            rows,
            sizes: rows.map(|row| row.map(f32::abs)),
            translation: translation.as_vec3().to_array(),
            norm: up(row_sums.max_element()),
            shift: up(translation.abs().max_element()),
            drift: up(DRIFT * noise) + f32::MIN_POSITIVE,
        }
    }

    /// Whether it is still right for the joint and the frame, up to its drift.
    pub(crate) fn is_still(&self, frame: &WorldFromModel, joint: &[DVec3; 4], reach: f64) -> bool {
        let (linear, translation) = in_frame(frame, joint);
        (0..3).all(|i| {
            let row = DVec3::from_array(self.rows[i].map(f64::from));
            let moved = (linear.row(i) - row).abs().element_sum() * reach;
            moved + (translation[i] - f64::from(self.translation[i])).abs() <= f64::from(self.drift)
        })
    }

    /// A bound on the coordinates of images of points with coordinates up to `reach`.
    #[inline(always)]
    pub(crate) fn reach(&self, reach: f32) -> f32 {
        self.norm * reach + self.shift
    }

    /// The images of eight boxes, given by their centres and half sizes.
    #[inline(always)]
    pub(crate) fn image<S: Simd>(&self, simd: S, [center, half]: &Ends<S>) -> Ends<S> {
        let mut ends = [[f32x8::splat(simd, 0.0); 3]; 2];
        for i in 0..3 {
            let [x, y, z] = self.rows[i].map(|entry| f32x8::splat(simd, entry));
            let middle = ((x * center[0] + y * center[1]) + z * center[2]) + f32x8::splat(simd, self.translation[i]);
            let [x, y, z] = self.sizes[i].map(|entry| f32x8::splat(simd, entry));
            let radius = (x * half[0] + y * half[1]) + z * half[2];
            ends[0][i] = middle - radius;
            ends[1][i] = middle + radius;
        }
        ends
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

/// The joint's map in `f64`.
fn in_frame(frame: &WorldFromModel, &[x, y, z, translation]: &[DVec3; 4]) -> (DMat3, DVec3) {
    let inverse = frame.inverse_linear();
    let linear = inverse * DMat3::from_cols(x, y, z);
    (linear, inverse * (translation - frame.translation()))
}

fn world_norm([x, y, z, _]: &[DVec3; 4]) -> f64 {
    (x.abs() + y.abs() + z.abs()).max_element()
}

fn translation_norm([.., translation]: &[DVec3; 4]) -> f64 {
    translation.abs().max_element()
}
