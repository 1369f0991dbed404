//! The blended boxes of a group of children: the paper's Eq. 3 within the budget, interval arithmetic beyond it, and an
//! outward widening for every rounding on the way.

use crate::bounds::BoxLanes;
use crate::tree::GroupTables;

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

/// Boxes that hold every vertex of each child, both its exact position and the one rounded to `f32`.
///
/// Cost: one pass over the group's local targets, `12` (or, where the budget ends, `24`) multiply-adds of eight lanes for
/// each with a weight that is not zero.
#[inline]
pub(super) fn blend_group(tables: GroupTables<'_>, weights: &[f32]) -> BoxLanes {
    let mut boxes = *tables.base;
    let mut reach = tables.base_reach;
    let mut active = 0_u32;
    // `a` sums to at most 1 in exact arithmetic: each subtraction below rounds by at most U.
    let mut budget = 1.0 - tables.targets.len() as f32 * (2.0 * U);
    for (local, slopes) in tables.targets.iter().zip(tables.slopes) {
        let weight = weights[local.target as usize];
        if weight == 0.0 {
            continue;
        }
        active += 1;
        reach += weight.abs() * local.reach;
        if weight < 0.0 {
            add(&mut boxes, weight, &slopes.interval, Ends::Swapped);
            continue;
        }
        let within = weight.min(budget);
        let beyond = weight - within;
        if within > 0.0 {
            budget -= within;
            add(&mut boxes, within, &slopes.reference, Ends::Kept);
        }
        if beyond > 0.0 {
            add(&mut boxes, beyond, &slopes.interval, Ends::Kept);
        }
    }
    let widening = widening(reach, active);
    for axis in 0..3 {
        boxes.min[axis].add(-widening);
        boxes.max[axis].add(widening);
    }
    boxes
}

/// A negative weight takes the lower end down by the largest displacement and the upper end up by the smallest.
#[derive(Clone, Copy)]
enum Ends {
    Kept,
    Swapped,
}

#[inline]
fn add(boxes: &mut BoxLanes, weight: f32, slopes: &BoxLanes, ends: Ends) {
    let (min, max) = match ends {
        Ends::Kept => (&slopes.min, &slopes.max),
        Ends::Swapped => (&slopes.max, &slopes.min),
    };
    for axis in 0..3 {
        boxes.min[axis].add_scaled(weight, &min[axis]);
        boxes.max[axis].add_scaled(weight, &max[axis]);
    }
}

/// How far box ends and vertices may be off their exact values, together.
///
/// With `reach = B + sum |w_k| D_k` and `m` active targets: a vertex is rounded `m + 1` times, a box end `m + 2` times and
/// once more when it is widened, `beyond` once, `reach` itself `m + 1` times relative to itself; each is at most
/// `U * reach`. Products that underflow add half the smallest subnormal each, `2 m + 1` of them and one here.
#[inline]
fn widening(reach: f32, active: u32) -> f32 {
    let roundings = (2 * active + 6) as f32;
    // 1.03 covers the products of rounding errors for up to 65535 targets.
    let relative = reach * (roundings * U * 1.03);
    relative + f32::from_bits(2 * active + 2)
}
