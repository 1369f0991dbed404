//! Which joints move a vertex, and the definition of a skinned vertex.

use std::ops::RangeInclusive;

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::Vec3A;

use super::influence_rows::InfluenceRows;
use super::influences::{Influence, SlotInfluences};
use crate::joints::JointMatrices;

/// Bounds on rounding errors count at least this many influences per vertex.
pub(crate) const FEW_INFLUENCES: usize = 8;

/// The influences of welded vertices.
#[derive(Clone, Debug)]
pub(crate) struct Skin {
    joint_count: usize,
    rows: InfluenceRows,
    /// The largest number of a vertex's influences, or [`FEW_INFLUENCES`] if that is more.
    most: usize,
    /// The largest sum of a vertex's weights, rounded up.
    max_sum: f64,
    /// The largest difference between the sum of a vertex's weights and 1, rounded up.
    max_missing: f64,
}

impl Skin {
    /// The influences of some vertices.
    pub(super) fn new(all: &SlotInfluences<'_>, vertices: &[u32]) -> Self {
        let mut skin = Self {
            joint_count: all.joint_count,
            rows: InfluenceRows::new(all, vertices),
            most: FEW_INFLUENCES,
            max_sum: 0.0,
            max_missing: 0.0,
        };
        for &vertex in vertices {
            let weights = || all.of(vertex as usize).map(|influence| f64::from(influence.weight));
            let (count, sum) = (weights().count(), weights().sum::<f64>());
            let rounding = sum_rounding(count) * (1.0 + sum);
            skin.most = skin.most.max(count);
            skin.max_sum = skin.max_sum.max(sum + rounding);
            skin.max_missing = skin.max_missing.max((1.0 - sum).abs() + rounding);
        }
        skin
    }

    pub(crate) fn joint_count(&self) -> usize {
        self.joint_count
    }

    /// The largest number of a vertex's influences, or [`FEW_INFLUENCES`] if that is more.
    pub(crate) fn most_influences(&self) -> usize {
        self.most
    }

    pub(crate) fn max_sum(&self) -> f64 {
        self.max_sum
    }

    /// A range that contains the sum of every vertex's weights.
    pub(crate) fn sums(&self) -> RangeInclusive<f64> {
        1.0 - self.max_missing..=self.max_sum
    }

    pub(crate) fn max_missing(&self) -> f64 {
        self.max_missing
    }

    /// A range that contains the difference of 1 and the exact sum of a vertex's weights.
    pub(crate) fn missing(&self, vertex: u32) -> [f64; 2] {
        let weights = || self.influences(vertex).map(|influence| f64::from(influence.weight));
        let sum: f64 = weights().sum();
        // Sums of numbers with 24 bits are exact in `f64` unless some are much smaller than others.
        let is_exact = weights().all(|weight: f64| weight >= 1.0 / (1 << 24) as f64) && sum <= 8.0;
        let rounding = if is_exact {
            0.0
        } else {
            sum_rounding(weights().count()) * (1.0 + sum)
        };
        [1.0 - sum - rounding, 1.0 - sum + rounding]
    }

    /// The influences of a vertex, without those of weight 0, in slot order; the first two may be swapped.
    #[inline(always)]
    pub(crate) fn influences(&self, vertex: u32) -> impl Iterator<Item = Influence> {
        self.rows.of_vertex(vertex)
    }

    /// The world position of a welded vertex, given its position after morphing. Every answer about skinned meshes is based on
    /// this definition.
    ///
    /// The vertex's matrix is `((w_0 J_0 + w_1 J_1) + w_2 J_2) + ...` per entry, in slot order. Zero weights are skipped, and
    /// weights are not normalised. The position is `((M_x p_x + M_y p_y) + M_z p_z) + M_t`, in the first three numbers. Everything is
    /// computed in `f64`, never fused. [`Skin::place_block`] does the same for eight vertices.
    #[inline(always)]
    pub(crate) fn place<S: Simd>(&self, simd: S, vertex: u32, position: Vec3A, joints: &JointMatrices) -> [f64; 4] {
        let mut blended = [f64x4::splat(simd, 0.0); 4];
        for influence in self.influences(vertex) {
            let weight = f64x4::splat(simd, f64::from(influence.weight));
            let matrix = joints.padded(influence.joint);
            for (sum, column) in blended.iter_mut().zip(matrix) {
                *sum += f64x4::from_slice(simd, column) * weight;
            }
        }
        let [x, y, z, translation] = blended;
        let along = |coordinate: f32| f64x4::splat(simd, f64::from(coordinate));
        let placed = ((x * along(position.x) + y * along(position.y)) + z * along(position.z)) + translation;
        let mut world = [0.0; 4];
        placed.store_slice(&mut world);
        world
    }

    pub(super) fn rows(&self) -> &InfluenceRows {
        &self.rows
    }
}

/// A bound on the relative rounding error of a sum of this many weights in `f64`.
pub(crate) fn sum_rounding(terms: usize) -> f64 {
    terms.max(FEW_INFLUENCES) as f64 * f64::EPSILON
}
