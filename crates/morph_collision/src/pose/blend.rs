//! Blends the boxes of a group of children: with the paper's Eq. 3 while the budget lasts, with interval arithmetic after that. Then
//! widens them to cover every rounding.

use fearless_simd::Simd;

use crate::bounds::{BoxLanes, Intervals, LANES, Slopes};
use crate::model::{MorphModel, Weights};
use crate::tree::{CornerLanes, GroupTables, PatchColumns};

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

/// If more targets than this are active, blending goes over all targets of a group. Not measured; flip-books have two.
pub(super) const FEW: usize = 8;

/// Sets `boxes` to boxes that contain every vertex of each child, both its exact position and the one rounded to `f32`. Returns a
/// bound on their absolute coordinates.
///
/// Cost: one pass over the group's local targets, or over the active ones if they are few. Each target with a nonzero weight costs
/// one multiply-add of eight lanes per row; the target that uses up the budget costs two.
#[inline(always)]
pub(super) fn blend_group<S: Simd>(simd: S, tables: GroupTables<'_>, weights: &Weights, boxes: &mut BoxLanes) -> f32 {
    let (widening, reach) = evaluate(simd, tables, weights, boxes);
    boxes.widen(simd, widening);
    // With 65,535 targets, the reach itself rounds by 0.4 %, the boxes by 0.8 %, and the widening is 1.2 %.
    reach * (1.0 + 2.5e-2)
}

/// Computes the boxes without widening. Returns by how much to widen them, and a bound on their absolute coordinates.
#[inline(always)]
pub(super) fn evaluate<S: Simd>(
    simd: S,
    tables: GroupTables<'_>,
    weights: &Weights,
    boxes: &mut BoxLanes,
) -> (f32, f32) {
    match tables.width {
        1 => evaluate_lanes::<S, 1>(simd, tables, weights, boxes),
        2 => evaluate_lanes::<S, 2>(simd, tables, weights, boxes),
        3 => evaluate_lanes::<S, 3>(simd, tables, weights, boxes),
        4 => evaluate_lanes::<S, 4>(simd, tables, weights, boxes),
        5 => evaluate_lanes::<S, 5>(simd, tables, weights, boxes),
        6 => evaluate_lanes::<S, 6>(simd, tables, weights, boxes),
        7 => evaluate_lanes::<S, 7>(simd, tables, weights, boxes),
        _ => evaluate_lanes::<S, LANES>(simd, tables, weights, boxes),
    }
}

#[inline(always)]
fn evaluate_lanes<S: Simd, const W: usize>(
    simd: S,
    tables: GroupTables<'_>,
    weights: &Weights,
    boxes: &mut BoxLanes,
) -> (f32, f32) {
    *boxes = *tables.base;
    let mut sums = Sums {
        reach: tables.base_reach,
        // Each subtraction from the budget rounds by at most `U`. Starting lower keeps the exact sum of the amounts at or below 1.
        budget: (1.0 - tables.reference_count as f32 * (4.0 * U)).max(0.0),
        active: 0,
        products: 0,
    };
    let mut few = [0; FEW];
    if let Some(indices) = few_indices(tables, weights, &mut few) {
        for &index in indices {
            sums.add::<S, W>(simd, tables, usize::from(index), weights, boxes);
        }
    } else {
        for index in 0..tables.targets.len() {
            sums.add::<S, W>(simd, tables, index, weights, boxes);
        }
    }
    (widening(sums.reach, sums.active, sums.products), sums.reach)
}

/// Running totals while the boxes are computed.
struct Sums {
    reach: f32,
    budget: f32,
    active: u32,
    products: u32,
}

impl Sums {
    /// Adds the target at `index` of the tables to the boxes.
    #[inline(always)]
    fn add<S: Simd, const W: usize>(
        &mut self,
        simd: S,
        tables: GroupTables<'_>,
        index: usize,
        weights: &Weights,
        boxes: &mut BoxLanes,
    ) {
        let local = &tables.targets[index];
        let weight = weights.all()[usize::from(local.target)];
        if weight == 0.0 {
            return;
        }
        self.active += 1;
        self.reach += weight.abs() * local.reach;
        let mut rest = weight;
        if index < tables.reference_count && weight > 0.0 && self.budget > 0.0 {
            let amount = weight.min(self.budget);
            self.budget -= amount;
            rest -= amount;
            self.products += 1;
            boxes.add_scaled(simd, amount, Slopes::<W>::at(tables.references, index));
        }
        if rest != 0.0 {
            self.products += 1;
            boxes.add_interval(simd, rest, Intervals::<W>::at(tables.intervals, index));
        }
    }
}

/// Sets `boxes` to boxes that contain the displacement of every vertex of each child from one weight vector to another, both exactly
/// and with positions rounded to `f32`.
///
/// Cost: one pass over the group's local targets. Each target whose weight differs costs one multiply-add of eight lanes per row.
#[inline(always)]
pub(super) fn blend_change<S: Simd>(simd: S, tables: GroupTables<'_>, weights: [&[f32]; 2], boxes: &mut BoxLanes) {
    match tables.width {
        1 => change_lanes::<S, 1>(simd, tables, weights, boxes),
        2 => change_lanes::<S, 2>(simd, tables, weights, boxes),
        3 => change_lanes::<S, 3>(simd, tables, weights, boxes),
        4 => change_lanes::<S, 4>(simd, tables, weights, boxes),
        5 => change_lanes::<S, 5>(simd, tables, weights, boxes),
        6 => change_lanes::<S, 6>(simd, tables, weights, boxes),
        7 => change_lanes::<S, 7>(simd, tables, weights, boxes),
        _ => change_lanes::<S, LANES>(simd, tables, weights, boxes),
    }
}

#[inline(always)]
fn change_lanes<S: Simd, const W: usize>(
    simd: S,
    tables: GroupTables<'_>,
    [before, now]: [&[f32]; 2],
    boxes: &mut BoxLanes,
) {
    *boxes = BoxLanes::default();
    let (mut reach, mut active, mut products) = (tables.base_reach, 0, 0);
    for (index, local) in tables.targets.iter().enumerate() {
        let target = usize::from(local.target);
        let (before, now) = (before[target], now[target]);
        let largest = before.abs().max(now.abs());
        active += u32::from(largest != 0.0);
        reach += largest * local.reach;
        let by = now - before;
        if by != 0.0 {
            products += 1;
            boxes.add_interval(simd, by, Intervals::<W>::at(tables.intervals, index));
        }
    }
    // With equal weights, both positions are rounded the same way.
    if products > 0 {
        // Two vertices round, each once per active target and once more. For each interval, the weight difference, the product and the
        // sum round. Twice the products is more than enough for that: a difference of weights is at most twice the larger one.
        boxes.widen(simd, widening(reach, 2 * active, 2 * products));
    }
}

/// The indices of the active targets in a group's tables, ascending. `None` if it is faster to go over all targets.
#[inline(always)]
pub(super) fn few_indices<'f>(
    tables: GroupTables<'_>,
    weights: &Weights,
    few: &'f mut [u16; FEW],
) -> Option<&'f [u16]> {
    if weights.active().len() > FEW || !weights.are_few_of(tables.targets.len()) {
        return None;
    }
    let mut count = 0;
    for index in weights
        .active()
        .iter()
        .filter_map(|&(target, _)| tables.index_of(target))
    {
        few[count] = index;
        count += 1;
    }
    let indices = &mut few[..count];
    indices.sort_unstable();
    Some(indices)
}

/// Blends the corners of a patch, in the order that
/// [`MorphModel::blend_vertex`](crate::model::MorphModel::blend_vertex) defines: `f32`, ascending targets, zero weights left out,
/// multiply then add. If a target moves only some vertices of the patch, the others add a zero, which changes no value.
#[inline(always)]
pub(super) fn blend_patch<S: Simd>(simd: S, patch: PatchColumns<'_>, weights: &Weights, corners: &mut CornerLanes) {
    *corners = *patch.base;
    // Patches have few targets (`LeafLanes::new`).
    for (&target, displacement) in patch.targets.iter().zip(patch.displacements) {
        let weight = weights.all()[usize::from(target)];
        if weight == 0.0 {
            continue;
        }
        for (row, delta) in corners.as_flattened_mut().iter_mut().zip(displacement.as_flattened()) {
            row.add_scaled(simd, weight, delta);
        }
    }
}

/// Approximately the largest widening of any group of a tree.
#[cold]
pub(super) fn max_widening(model: &MorphModel, weights: &Weights) -> f32 {
    let mut reach = model.base_reach();
    for &(target, weight) in weights.active() {
        reach += weight.abs() * model.target_reach()[target as usize];
    }
    let active = weights.active().len() as u32;
    widening(reach, active, 3 * active)
}

/// An error bound per coordinate for boxes and vertices together; derived in docs/numerics.md, "Blended boxes".
///
/// Let `reach = B + sum |w_k| D_k` and `m` be the number of active targets.
///
/// - A vertex rounds `m + 1` times.
/// - A row rounds once per product, once per sum, and once when it is widened.
/// - The rest of a weight, which multiplies the interval, rounds once.
/// - `reach` itself has a relative error of `m + 1` roundings.
///
/// Each rounding is at most `U * reach`. A product that underflows adds half the smallest subnormal.
#[inline(always)]
fn widening(reach: f32, active: u32, products: u32) -> f32 {
    let roundings = (active + 2 * products + 8) as f32;
    // 1.03 covers the second-order terms for up to 65535 targets.
    reach * (roundings * U * 1.03) + f32::from_bits(2 * (active + products) + 2)
}
