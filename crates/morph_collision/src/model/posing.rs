//! Kernels that pose a block of vertices side by side, with the bits of the definitions of one vertex: [`MorphModel::blend_vertex`] and
//! [`Skin::place`].

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x4};

use super::blocks::{BLOCK, BlockVectors};
use super::influence_rows::InfluenceRow;
use super::{MorphModel, Skin, Weights};
use crate::joints::{Columns, JointMatrices};

/// Half a block.
const HALF: usize = BLOCK / 2;

impl MorphModel {
    /// The positions of a block's vertices before joints and placement, by coordinate. Lanes without a vertex repeat the last one.
    #[inline(always)]
    pub(crate) fn blend_block<S: Simd>(&self, simd: S, block: usize, weights: &Weights) -> [f32x8<S>; 3] {
        let (base, targets, deltas) = self.block(block);
        let mut positions = base.load(simd);
        // Not `Weights::visit`: a closure may lose the instruction set.
        if weights.are_few_of(targets.len()) {
            let mut from = 0;
            for &(target, weight) in weights.active() {
                if let Some(place) = Weights::find(targets, target, &mut from) {
                    add_scaled(simd, &mut positions, weight, &deltas[place]);
                }
            }
        } else {
            for (&target, deltas) in targets.iter().zip(deltas) {
                let weight = weights.all()[usize::from(target)];
                if weight != 0.0 {
                    add_scaled(simd, &mut positions, weight, deltas);
                }
            }
        }
        positions
    }
}

#[inline(always)]
fn add_scaled<S: Simd>(simd: S, positions: &mut [f32x8<S>; 3], weight: f32, deltas: &BlockVectors) {
    let weight = f32x8::splat(simd, weight);
    let [x, y, z] = deltas.load(simd);
    positions[0] += x * weight;
    positions[1] += y * weight;
    positions[2] += z * weight;
}

impl Skin {
    /// The world positions of a block's vertices, given their positions after morphing. The fourth numbers are 0.
    #[inline(always)]
    pub(crate) fn place_block<S: Simd>(
        &self,
        simd: S,
        block: usize,
        positions: [f32x8<S>; 3],
        joints: &JointMatrices,
        placed: &mut [[f64; 4]; BLOCK],
    ) {
        let [x, y, z] = positions;
        let (x, y, z) = (simd.widen_f32x8(x), simd.widen_f32x8(y), simd.widen_f32x8(z));
        let halves = [[x.0, y.0, z.0], [x.1, y.1, z.1]];
        let mut world = [[f64x4::splat(simd, 0.0); 3]; 2];
        let rows = self.rows().of_block(block);
        for axis in 0..3 {
            let [low, high] = match rows {
                [row] if row.is_whole => one_matrix(simd, joints.padded(row.joint), axis),
                _ => sum_of_matrices(simd, rows, joints, axis),
            };
            world[0][axis] = image(low, halves[0]);
            world[1][axis] = image(high, halves[1]);
        }
        let (low, high) = placed.split_at_mut(HALF);
        store(simd, world[0], low);
        store(simd, world[1], high);
    }
}

/// The entries of each vertex's matrix along one axis, for both halves of a block.
type Entries<S> = [[f64x4<S>; 4]; 2];

#[inline(always)]
fn sum_of_matrices<S: Simd>(simd: S, rows: &[InfluenceRow], joints: &JointMatrices, axis: usize) -> Entries<S> {
    // The definition starts every sum at 0. Unless it does so for the translation, the other entries' zeros may have either sign:
    // the sum of four terms, of which the last one is not -0, is the same.
    let mut sums = [[f64x4::splat(simd, 0.0); 4]; 2];
    for row in rows {
        let matrix = joints.padded(row.joint);
        let (low, high) = simd.widen_f32x8(f32x8::from_slice(simd, &row.weights));
        for column in 0..4 {
            let entry = f64x4::splat(simd, matrix[column][axis]);
            sums[0][column] += entry * low;
            sums[1][column] += entry * high;
        }
    }
    sums
}

/// The same for a single joint whose weights are 1.
#[inline(always)]
fn one_matrix<S: Simd>(simd: S, matrix: &Columns, axis: usize) -> Entries<S> {
    let mut entries = [f64x4::splat(simd, 0.0); 4];
    for column in 0..4 {
        // The sum turns -0 into 0, as in the definition.
        entries[column] = f64x4::splat(simd, matrix[column][axis] + 0.0);
    }
    [entries; 2]
}

/// One coordinate of four placed vertices.
#[inline(always)]
fn image<S: Simd>(entries: [f64x4<S>; 4], [x, y, z]: [f64x4<S>; 3]) -> f64x4<S> {
    ((entries[0] * x + entries[1] * y) + entries[2] * z) + entries[3]
}

/// Stores the coordinates of four vertices.
#[inline(always)]
fn store<S: Simd>(simd: S, [x, y, z]: [f64x4<S>; 3], placed: &mut [[f64; 4]]) {
    let (xy, z0) = (x.interleave(y), z.interleave(f64x4::splat(simd, 0.0)));
    let ((xy0, xy1), (xy2, xy3)) = (xy.0.split(), xy.1.split());
    let ((z0_0, z0_1), (z0_2, z0_3)) = (z0.0.split(), z0.1.split());
    xy0.combine(z0_0).store_slice(&mut placed[0]);
    xy1.combine(z0_1).store_slice(&mut placed[1]);
    xy2.combine(z0_2).store_slice(&mut placed[2]);
    xy3.combine(z0_3).store_slice(&mut placed[3]);
}
