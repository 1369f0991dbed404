//! The blended volumes of a group of children: the paper's Eq. 3 within the budget, interval arithmetic beyond it, and an
//! outward widening for every rounding on the way.

use fearless_simd::Simd;

use crate::bounds::Volume;
use crate::model::MorphModel;
use crate::tree::{CornerLanes, GroupTables, PatchColumns};

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

/// Volumes that hold every vertex of each child with tables, both its exact position and the one rounded to `f32`, and how
/// far the others are to be widened for the same.
///
/// `amounts` is scratch memory. Cost: one pass over the group's local targets and steps, one multiply-add of eight lanes
/// per row for each of them that gets some weight.
#[inline(always)]
pub(super) fn blend_group<S: Simd, V: Volume>(
    simd: S,
    tables: GroupTables<'_, V>,
    weights: &[f32],
    amounts: &mut Vec<f32>,
    volume: &mut V,
) -> f32 {
    let widening = evaluate(simd, tables, weights, amounts, volume);
    volume.widen(simd, widening);
    widening
}

/// The same before it is widened, and by how much it is to be.
#[inline(always)]
pub(super) fn evaluate<S: Simd, V: Volume>(
    simd: S,
    tables: GroupTables<'_, V>,
    weights: &[f32],
    amounts: &mut Vec<f32>,
    volume: &mut V,
) -> f32 {
    let mut reach = tables.base_reach;
    let (mut active, mut sum, mut least) = (0_u32, 0.0_f32, 0.0_f32);
    for local in tables.targets {
        let weight = weights[local.target as usize];
        let magnitude = weight.abs();
        reach += magnitude * local.reach;
        active += u32::from(magnitude > 0.0);
        (sum, least) = (sum + magnitude, least.min(weight));
    }
    *volume = *tables.base;
    if tables.lanes == 0 || active == 0 {
        return widening(reach, active, active);
    }
    let mut room = V::default();
    if tables.whole_weights && least >= 0.0 && sum <= room_for(&tables) {
        // The budget holds all weights: each goes to its reference as it is.
        for (i, step) in tables.steps.iter().enumerate() {
            let weight = weights[tables.targets[step.local as usize].target as usize];
            if weight > 0.0 {
                volume.add_scaled(simd, weight, tables.references.column(i, &mut room));
            }
        }
        return widening(reach, active, 2 * active);
    }
    let mut products = active;
    amounts.clear();
    amounts.extend(tables.targets.iter().map(|local| weights[local.target as usize].abs()));
    spend_budget(&tables, weights, amounts);
    let (rests, steps) = amounts.split_at(tables.targets.len());
    for (i, (local, &rest)) in tables.targets.iter().zip(rests).enumerate() {
        if rest > 0.0 {
            products += 1;
            let weight = rest.copysign(weights[local.target as usize]);
            volume.add_interval(simd, weight, tables.intervals.column(i, &mut room));
        }
    }
    for (i, &amount) in steps.iter().enumerate() {
        if amount > 0.0 {
            products += 1;
            volume.add_scaled(simd, amount, tables.references.column(i, &mut room));
        }
    }
    widening(reach, active, products)
}

/// Volumes as [`blend_group`]'s, from an anchor's: tight at weights `w*`, moved by the interval form of `w - w*`.
#[inline(always)]
pub(super) fn move_anchored<S: Simd, V: Volume>(
    simd: S,
    tables: GroupTables<'_, V>,
    anchored: &V,
    anchor: &[f32],
    differences: &[f32],
    weights: &[f32],
    volume: &mut V,
) -> f32 {
    let widening = evaluate_anchored(simd, tables, anchored, anchor, differences, weights, volume);
    volume.widen(simd, widening);
    widening
}

/// The same before it is widened, and by how much it is to be.
#[inline(always)]
pub(super) fn evaluate_anchored<S: Simd, V: Volume>(
    simd: S,
    tables: GroupTables<'_, V>,
    anchored: &V,
    anchor: &[f32],
    differences: &[f32],
    weights: &[f32],
    volume: &mut V,
) -> f32 {
    *volume = *anchored;
    let mut room = V::default();
    let mut reach = tables.base_reach;
    let (mut active, mut products) = (0, 0);
    for (i, local) in tables.targets.iter().enumerate() {
        // In-between targets are made of the others.
        let k = local.target as usize;
        let (Some(&difference), Some(&from), Some(&to)) = (differences.get(k), anchor.get(k), weights.get(k)) else {
            continue;
        };
        active += u32::from(from != 0.0) + u32::from(to != 0.0);
        reach += (from.abs() + to.abs() + difference.abs()) * local.reach;
        if difference != 0.0 && tables.lanes != 0 {
            products += 1;
            volume.add_interval(simd, difference, tables.intervals.column(i, &mut room));
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

/// Moves weight from the intervals to the scaled references, most gain per cost first, until the budget is spent.
///
/// `amounts` holds the weight left to each interval, and gets one more entry per step: the weight at its reference.
#[inline(always)]
fn spend_budget<V: Volume>(tables: &GroupTables<'_, V>, weights: &[f32], amounts: &mut Vec<f32>) {
    let targets = tables.targets.len();
    let mut budget = room_for(tables);
    for step in tables.steps {
        let local = step.local as usize;
        let source = step.after.map_or(local, |earlier| targets + earlier as usize);
        let weight = weights[tables.targets[local].target as usize];
        let usable = if (weight < 0.0) == step.negative {
            amounts[source]
        } else {
            0.0
        };
        let amount = usable.min(budget / step.cost);
        budget = (budget - amount * step.cost).max(0.0);
        amounts[source] -= amount;
        amounts.push(amount);
    }
}

/// The budget in `f32`. What is spent stays below 1 in exact arithmetic: a step rounds at most four times, each time by at most
/// `U`.
#[inline(always)]
fn room_for<V>(tables: &GroupTables<'_, V>) -> f32 {
    (1.0 - tables.steps.len() as f32 * (4.0 * U)).max(0.0)
}

/// As much as any group of a tree may be widened, about.
#[cold]
pub(super) fn most_widening(model: &MorphModel, spread: &[f32]) -> f32 {
    let mut reach = model.base_reach();
    let mut active = 0;
    for (weight, target) in spread.iter().zip(model.target_reach()) {
        reach += weight.abs() * target;
        active += u32::from(*weight != 0.0);
    }
    widening(reach, active, 3 * active)
}

/// How far volumes and vertices may be off their exact values, together, per coordinate.
///
/// With `reach = B + sum |w_k| D_k` and `m` active targets: a vertex is rounded `m + 1` times, a row at most once per
/// product and once per sum, and once more when it is widened; moving weight from one product to another rounds once per
/// product; the split over in-betweens rounds twice, `reach` itself `m + 1` times relative to itself. Each is at most
/// `U * reach`. Products that underflow add half the smallest subnormal each.
#[inline(always)]
fn widening(reach: f32, active: u32, products: u32) -> f32 {
    let roundings = (active + 2 * products + 8) as f32;
    // 1.03 covers the products of rounding errors for up to 65535 targets.
    reach * (roundings * U * 1.03) + f32::from_bits(2 * (active + products) + 2)
}
