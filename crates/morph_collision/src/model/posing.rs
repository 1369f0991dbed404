//! Kernels that pose a block of vertices side by side, with the bits of the definitions of one vertex: [`MorphModel::blend_vertex`] and
//! [`Skin::place`].

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x8, f64x4};

use super::blocks::{BLOCK, BlockVectors};
use super::influence_rows::InfluenceRow;
use super::{MorphModel, Skin, Weights};
use crate::joints::{Columns, JointMatrices};

/// The positions of a block's vertices before joints and placement. The fourth numbers are 0.
pub(crate) type BlendedBlock = [[f32; 4]; BLOCK];
/// The world positions of a block's vertices. The fourth numbers are 0.
pub(crate) type PlacedBlock = [[f64; 4]; BLOCK];

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
                if let Some(index) = Weights::find(targets, target, &mut from) {
                    add_scaled(simd, &mut positions, weight, &deltas[index]);
                }
            }
        } else {
            let all = weights.all();
            for (&target, deltas) in targets.iter().zip(deltas) {
                let weight = all[usize::from(target)];
                if weight != 0.0 {
                    add_scaled(simd, &mut positions, weight, deltas);
                }
            }
        }
        positions
    }

    /// The same, by vertex.
    #[inline(always)]
    pub(crate) fn blend_points<S: Simd>(&self, simd: S, block: usize, weights: &Weights, points: &mut BlendedBlock) {
        let [x, y, z] = self.blend_block(simd, block, weights);
        let ((x, x_high), (y, y_high), (z, z_high)) = (x.split(), y.split(), z.split());
        let (low, high) = points.as_flattened_mut().split_at_mut(2 * BLOCK);
        let zero = f32x4::splat(simd, 0.0);
        f32x4::store_four_interleaved([x, y, z, zero], low);
        f32x4::store_four_interleaved([x_high, y_high, z_high, zero], high);
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
    /// The world positions of a block's vertices, given their positions after morphing.
    #[inline(always)]
    pub(crate) fn place_block<S: Simd>(
        &self,
        simd: S,
        block: usize,
        positions: [f32x8<S>; 3],
        joints: &JointMatrices,
        placed: &mut PlacedBlock,
    ) {
        let [x, y, z] = positions;
        let (x, y, z) = (simd.widen_f32x8(x), simd.widen_f32x8(y), simd.widen_f32x8(z));
        let halves = [[x.0, y.0, z.0], [x.1, y.1, z.1]];
        // The usual numbers of joints have code of their own, without inner loops.
        match self.rows().of_block(block) {
            [row] if row.is_whole => by_one_matrix(simd, joints.padded(row.joint), halves, placed),
            [a, b] => by_matrices(simd, [a, b], joints, halves, placed),
            [a, b, c] => by_matrices(simd, [a, b, c], joints, halves, placed),
            [a, b, c, d] => by_matrices(simd, [a, b, c, d], joints, halves, placed),
            rows => by_many_matrices(simd, rows, joints, halves, placed),
        }
    }
}

/// The coordinates of a block's vertices, for both halves.
type Halves<S> = [[f64x4<S>; 3]; 2];

/// Places vertices that one joint moves, with weight 1.
#[inline(always)]
fn by_one_matrix<S: Simd>(simd: S, matrix: &Columns, halves: Halves<S>, placed: &mut PlacedBlock) {
    let mut world = halves;
    for axis in 0..3 {
        let mut entries = [f64x4::splat(simd, 0.0); 4];
        for column in 0..4 {
            entries[column] = f64x4::splat(simd, matrix[column][axis]);
        }
        world[0][axis] = image(entries, halves[0]);
        world[1][axis] = image(entries, halves[1]);
    }
    store(simd, world, placed);
}

/// Places vertices that a known number of joints move.
///
/// Sums start with the first product instead of 0, except for translations. So the zeros in the rest of the matrix may have another sign
/// than in the definition, but not their sums with a translation, which is never -0.
#[inline(always)]
fn by_matrices<S: Simd, const N: usize>(
    simd: S,
    rows: [&InfluenceRow; N],
    joints: &JointMatrices,
    halves: Halves<S>,
    placed: &mut PlacedBlock,
) {
    let zero = f64x4::splat(simd, 0.0);
    let mut world = halves;
    let (mut low, mut high) = ([zero; N], [zero; N]);
    for (row, (low, high)) in rows.iter().zip(low.iter_mut().zip(&mut high)) {
        (*low, *high) = simd.widen_f32x8(f32x8::from_slice(simd, &row.weights));
    }
    let matrices = rows.map(|row| joints.padded(row.joint));
    for axis in 0..3 {
        let mut entries = [[zero; 4]; 2];
        for column in 0..4 {
            for i in 0..N {
                let entry = f64x4::splat(simd, matrices[i][column][axis]);
                let products = [entry * low[i], entry * high[i]];
                if i == 0 && column < 3 {
                    (entries[0][column], entries[1][column]) = (products[0], products[1]);
                } else {
                    entries[0][column] += products[0];
                    entries[1][column] += products[1];
                }
            }
        }
        world[0][axis] = image(entries[0], halves[0]);
        world[1][axis] = image(entries[1], halves[1]);
    }
    store(simd, world, placed);
}

/// Places vertices that any number of joints move.
#[inline(always)]
fn by_many_matrices<S: Simd>(
    simd: S,
    rows: &[InfluenceRow],
    joints: &JointMatrices,
    halves: Halves<S>,
    placed: &mut PlacedBlock,
) {
    let mut world = halves;
    for axis in 0..3 {
        let mut entries = [[f64x4::splat(simd, 0.0); 4]; 2];
        for row in rows {
            let matrix = joints.padded(row.joint);
            let (low, high) = simd.widen_f32x8(f32x8::from_slice(simd, &row.weights));
            for column in 0..4 {
                let entry = f64x4::splat(simd, matrix[column][axis]);
                entries[0][column] += entry * low;
                entries[1][column] += entry * high;
            }
        }
        world[0][axis] = image(entries[0], halves[0]);
        world[1][axis] = image(entries[1], halves[1]);
    }
    store(simd, world, placed);
}

/// One coordinate of four placed vertices.
#[inline(always)]
fn image<S: Simd>(entries: [f64x4<S>; 4], [x, y, z]: [f64x4<S>; 3]) -> f64x4<S> {
    ((entries[0] * x + entries[1] * y) + entries[2] * z) + entries[3]
}

#[inline(always)]
fn store<S: Simd>(simd: S, [low, high]: Halves<S>, placed: &mut PlacedBlock) {
    let [a, b, c, d, e, f, g, h] = placed;
    store_half(simd, low, [a, b, c, d]);
    store_half(simd, high, [e, f, g, h]);
}

#[inline(always)]
fn store_half<S: Simd>(simd: S, [x, y, z]: [f64x4<S>; 3], placed: [&mut [f64; 4]; BLOCK / 2]) {
    let (xy, z0) = (x.interleave(y), z.interleave(f64x4::splat(simd, 0.0)));
    let ((xy0, xy1), (xy2, xy3)) = (xy.0.split(), xy.1.split());
    let ((z0_0, z0_1), (z0_2, z0_3)) = (z0.0.split(), z0.1.split());
    let [a, b, c, d] = placed;
    xy0.combine(z0_0).store_slice(a);
    xy1.combine(z0_1).store_slice(b);
    xy2.combine(z0_2).store_slice(c);
    xy3.combine(z0_3).store_slice(d);
}
