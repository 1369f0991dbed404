//! Blending the boxes of a group of children: the paper's Eq. 3 while the budget lasts, interval arithmetic after that, and an
//! outward widening that covers every rounding.

use fearless_simd::Simd;

use crate::bounds::BoxLanes;
use crate::model::MorphModel;
use crate::tree::{CornerLanes, GroupTables, PatchColumns};

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

/// Sets `boxes` to boxes that hold every vertex of each child, both its exact position and the one rounded to `f32`.
///
/// Cost: one pass over the group's local targets. Each target with a nonzero weight takes one multiply-add of eight lanes per
/// row, or two for the target that uses up the budget.
#[inline(always)]
pub(super) fn blend_group<S: Simd>(simd: S, tables: GroupTables<'_>, weights: &[f32], boxes: &mut BoxLanes) {
    let widening = evaluate(simd, tables, weights, boxes);
    boxes.widen(simd, widening);
}

/// Computes the boxes before widening, and returns how much they must be widened.
#[inline(always)]
pub(super) fn evaluate<S: Simd>(simd: S, tables: GroupTables<'_>, weights: &[f32], boxes: &mut BoxLanes) -> f32 {
    *boxes = *tables.base;
    let mut reach = tables.base_reach;
    let (mut active, mut products) = (0, 0);
    // Each subtraction from the budget rounds by at most `U`; starting lower keeps the exact sum of the amounts at most 1.
    let mut budget = (1.0 - tables.references.len() as f32 * (4.0 * U)).max(0.0);
    for (i, (local, interval)) in tables.targets.iter().zip(tables.intervals).enumerate() {
        let weight = weights[local.target as usize];
        if weight == 0.0 {
            continue;
        }
        active += 1;
        reach += weight.abs() * local.reach;
        let mut rest = weight;
        if let Some(reference) = tables.references.get(i)
            && weight > 0.0
            && budget > 0.0
        {
            let amount = weight.min(budget);
            budget -= amount;
            rest -= amount;
            products += 1;
            boxes.add_scaled(simd, amount, reference);
        }
        if rest != 0.0 {
            products += 1;
            boxes.add_interval(simd, rest, interval);
        }
    }
    widening(reach, active, products)
}

/// Blends the corners of a patch, in the order that
/// [`MorphModel::blend_vertex`](crate::model::MorphModel::blend_vertex) defines: `f32`, ascending targets, zero weights left out,
/// multiply then add. Where a target moves only some vertices of the patch, the others add a zero, which changes no value.
#[inline(always)]
pub(super) fn blend_patch<S: Simd>(simd: S, patch: PatchColumns<'_>, weights: &[f32], corners: &mut CornerLanes) {
    *corners = *patch.base;
    for (&target, displacement) in patch.targets.iter().zip(patch.displacements) {
        let weight = weights[target as usize];
        if weight == 0.0 {
            continue;
        }
        for (row, delta) in corners.as_flattened_mut().iter_mut().zip(displacement.as_flattened()) {
            row.add_scaled(simd, weight, delta);
        }
    }
}

/// About the most that any group of a tree is widened.
#[cold]
pub(super) fn max_widening(model: &MorphModel, weights: &[f32]) -> f32 {
    let mut reach = model.base_reach();
    let mut active = 0;
    for (weight, target) in weights.iter().zip(model.target_reach()) {
        reach += weight.abs() * target;
        active += u32::from(*weight != 0.0);
    }
    widening(reach, active, 3 * active)
}

/// An error bound per coordinate for boxes and vertices together; derived in docs/numerics.md, "Blended boxes".
///
/// Let `reach = B + sum |w_k| D_k` and `m` be the number of active targets. A vertex rounds `m + 1` times. A row rounds once
/// per product, once per sum and once when it is widened. The rest of a weight, for its interval, rounds once. `reach` itself
/// has a relative error of `m + 1` roundings. Each rounding is at most `U * reach`. A product that underflows adds half the
/// smallest subnormal.
#[inline(always)]
fn widening(reach: f32, active: u32, products: u32) -> f32 {
    let roundings = (active + 2 * products + 8) as f32;
    // 1.03 covers the second-order terms for up to 65535 targets.
    reach * (roundings * U * 1.03) + f32::from_bits(2 * (active + products) + 2)
}
