//! The boxes of a group's children under joints (docs/skinning.md). Each cluster is blended as it is before joints move it. Its
//! strongest joint then takes the box to the group's frame, and a correction covers what the other joints may do.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};

use super::blend::blend_group;
use crate::bounds::{BoxLanes, Ends, JointMap, LANES, lanes_of};
use crate::model::Weights;
use crate::tree::{Block, KEPT_IMAGES, SkinTables};

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;
/// Sums of larger coordinates could overflow, so their boxes are infinite.
pub(super) const MAX_REACH: f32 = 1e37;

/// Sets `boxes` to boxes of a group's children, in the group's frame, that contain every vertex. Returns by how much they were
/// widened.
///
/// `map` returns a map by its index. `origin` is a bound on the coordinates of the world's origin in the frame.
#[inline(always)]
pub(super) fn blend_skinned<'m, S: Simd>(
    simd: S,
    skin: &SkinTables,
    group: usize,
    weights: &Weights,
    map: impl Fn(u32) -> &'m JointMap,
    origin: f32,
    boxes: &mut BoxLanes,
) -> f32 {
    let all = |value| [f32x8::splat(simd, value); 3];
    boxes.store(all(f32::INFINITY), all(f32::NEG_INFINITY));
    let mut widest = 0.0_f32;
    let mut cluster = BoxLanes::default();
    let mut kept = [[all(0.0); 2]; KEPT_IMAGES];
    for block in skin.blocks(group) {
        let block = skin.block(block);
        let reach = blend_group(simd, block.tables, weights, &mut cluster);
        let own = cluster.ends(simd);
        let (ends, widening) = match block.pivots {
            [pivot] if block.rows.is_empty() && map(pivot.map).is_identity && block.missing == 0.0 => (own, 0.0),
            _ => moved(simd, &block, own, reach, &map, origin, &mut kept),
        };
        widest = widest.max(widening);
        if *block.children == EACH {
            boxes.join(simd, ends, block.lanes);
        } else {
            cluster.store(ends[0], ends[1]);
            for lane in lanes_of(block.lanes) {
                boxes.join_one(usize::from(block.children[lane % LANES]), &cluster, lane);
            }
        }
    }
    widest
}

/// The children of a block in which lane `i` is child `i`.
const EACH: [u8; LANES] = [0, 1, 2, 3, 4, 5, 6, 7];

/// The boxes of a block's clusters under their joints, and by how much they were widened. `own` are the boxes before joints move them,
/// with coordinates up to `reach`. `kept` is scratch memory.
#[inline(always)]
fn moved<'m, S: Simd>(
    simd: S,
    block: &Block<'_>,
    own: Ends<S>,
    reach: f32,
    map: &impl Fn(u32) -> &'m JointMap,
    origin: f32,
    kept: &mut [Ends<S>; KEPT_IMAGES],
) -> (Ends<S>, f32) {
    let half = f32x8::splat(simd, 0.5);
    let [low, high] = own;
    let mut middle = [low, high];
    for axis in 0..3 {
        middle[0][axis] = (low[axis] + high[axis]) * half;
        middle[1][axis] = (high[axis] - low[axis]) * half;
    }
    let image = |map: &JointMap| if map.is_identity { own } else { map.image(simd, &middle) };
    let (mut farthest, mut drift) = (0.0_f32, 0.0_f32);
    let mut note = |map: &JointMap| {
        farthest = farthest.max(map.reach(reach));
        drift = drift.max(map.drift);
    };
    let mut pivot = own;
    for (i, of) in block.pivots.iter().enumerate() {
        let map = map(of.map);
        note(map);
        let (image, is_its) = (image(map), mask32x8::from_bitmask(simd, u64::from(of.lanes)));
        if let Some(kept) = kept.get_mut(i) {
            *kept = image;
        }
        for end in 0..2 {
            for axis in 0..3 {
                pivot[end][axis] = is_its.select(image[end][axis], pivot[end][axis]);
            }
        }
    }
    let mut ends = pivot;
    for row in block.rows {
        let image = match kept.get(usize::from(row.pivot)) {
            Some(kept) => *kept,
            None => {
                let map = map(row.map);
                note(map);
                image(map)
            }
        };
        let (least, most) = (row.low.load(simd), row.high.load(simd));
        for axis in 0..3 {
            let (low, high) = (image[0][axis] - pivot[0][axis], image[1][axis] - pivot[1][axis]);
            ends[0][axis] += (least * low).min(most * low);
            ends[1][axis] += (least * high).max(most * high);
        }
    }
    let widening = widening(block, farthest, drift, origin);
    let is_bounded = widening + farthest * (1.0 + 2.0 * block.weight) <= MAX_REACH;
    // `is_bounded` is false for NaN.
    if !is_bounded {
        let all = |value| [f32x8::splat(simd, value); 3];
        return ([all(f32::NEG_INFINITY), all(f32::INFINITY)], f32::INFINITY);
    }
    let by = f32x8::splat(simd, widening);
    let [low, high] = &mut ends;
    for (low, high) in low.iter_mut().zip(high) {
        *low -= by;
        *high += by;
    }
    (ends, widening)
}

/// A bound on all rounding errors of [`moved`]; derived in docs/numerics.md, "Boxes under joints".
#[inline(always)]
fn widening(block: &Block<'_>, farthest: f32, drift: f32, origin: f32) -> f32 {
    let (others, rows) = (block.weight, block.rows.len() as f32);
    let missing = if block.missing > 0.0 {
        block.missing * (origin + farthest) * 1.001
    } else {
        0.0
    };
    let roundings = 10.0 + 24.0 * others + (rows + 1.0) * (1.0 + 2.0 * others);
    farthest * (roundings * U * 1.03)
        + drift * (1.0 + 2.0 * others) * 1.001
        + missing
        + (rows + 2.0) * (1.0 + others) * 1e-42
}
