//! The blended boxes of a group of children: the paper's Eq. 3 within the budget, interval arithmetic beyond it, and an
//! outward widening for every rounding on the way.

use fearless_simd::Simd;

use super::anchor::Anchored;
use crate::bounds::BoxLanes;
use crate::model::MorphModel;
use crate::tree::{CornerLanes, GroupTables, PatchColumns};

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

/// Makes `boxes` hold every vertex of each child, both its exact position and the one rounded to `f32`.
///
/// Cost: one pass over the group's local targets, one multiply-add of eight lanes per row for each of them that gets some
/// weight, or two where the budget ends.
#[inline(always)]
pub(super) fn blend_group<S: Simd>(simd: S, tables: GroupTables<'_>, weights: &[f32], boxes: &mut BoxLanes) {
    let widening = evaluate(simd, tables, weights, boxes);
    boxes.widen(simd, widening);
}

/// The same before it is widened, and by how much it is to be.
#[inline(always)]
pub(super) fn evaluate<S: Simd>(simd: S, tables: GroupTables<'_>, weights: &[f32], boxes: &mut BoxLanes) -> f32 {
    *boxes = *tables.base;
    let mut reach = tables.base_reach;
    let (mut active, mut products) = (0, 0);
    let mut budget = budget(tables.references.len());
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

/// Boxes as [`blend_group`]'s, from an anchor's: tight at weights `w*`, moved by the interval form of `w - w*`.
#[inline(always)]
pub(super) fn move_anchored<S: Simd>(
    simd: S,
    tables: GroupTables<'_>,
    anchor: Anchored<'_>,
    weights: &[f32],
    boxes: &mut BoxLanes,
) {
    let widening = evaluate_anchored(simd, tables, anchor, weights, boxes);
    boxes.widen(simd, widening);
}

/// The same before it is widened, and by how much it is to be.
#[inline(always)]
pub(super) fn evaluate_anchored<S: Simd>(
    simd: S,
    tables: GroupTables<'_>,
    anchor: Anchored<'_>,
    weights: &[f32],
    boxes: &mut BoxLanes,
) -> f32 {
    *boxes = *anchor.boxes;
    let mut reach = tables.base_reach;
    let (mut active, mut products) = (0, 0);
    for (local, interval) in tables.targets.iter().zip(tables.intervals) {
        let k = local.target as usize;
        let (difference, from, to) = (anchor.differences[k], anchor.weights[k], weights[k]);
        active += u32::from(from != 0.0) + u32::from(to != 0.0);
        reach += (from.abs() + to.abs() + difference.abs()) * local.reach;
        if difference != 0.0 {
            products += 1;
            boxes.add_interval(simd, difference, interval);
        }
    }
    widening(reach, active, products)
}

/// The posed corners of a patch from its base corners: `f32`, ascending target order, zero weights left out, multiply then
/// add, as [`MorphModel::blend_vertex`](crate::model::MorphModel::blend_vertex). A displacement of zero, which a vertex has
/// that others in the patch are moved without, changes no value.
#[inline(always)]
pub(super) fn blend_patch<S: Simd>(simd: S, patch: PatchColumns<'_>, weights: &[f32], corners: &mut CornerLanes) {
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

/// The budget in `f32`. What is spent stays below 1 in exact arithmetic: taking an amount from it rounds once, by at most `U`.
#[inline(always)]
fn budget(references: usize) -> f32 {
    (1.0 - references as f32 * (4.0 * U)).max(0.0)
}

/// As much as any group of a tree may be widened, about.
#[cold]
pub(super) fn most_widening(model: &MorphModel, weights: &[f32]) -> f32 {
    let mut reach = model.base_reach();
    let mut active = 0;
    for (weight, target) in weights.iter().zip(model.target_reach()) {
        reach += weight.abs() * target;
        active += u32::from(*weight != 0.0);
    }
    widening(reach, active, 3 * active)
}

/// How far boxes and vertices may be off their exact values, together, per coordinate.
///
/// With `reach = B + sum |w_k| D_k` and `m` active targets: a vertex is rounded `m + 1` times, a row at most once per
/// product and once per sum, and once more when it is widened; what is left of a weight for its interval rounds once;
/// `reach` itself `m + 1` times relative to itself. Each is at most `U * reach`. Products that underflow add half the smallest
/// subnormal each.
#[inline(always)]
fn widening(reach: f32, active: u32, products: u32) -> f32 {
    let roundings = (active + 2 * products + 8) as f32;
    // 1.03 covers the products of rounding errors for up to 65535 targets.
    reach * (roundings * U * 1.03) + f32::from_bits(2 * (active + products) + 2)
}
