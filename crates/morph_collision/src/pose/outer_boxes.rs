//! Boxes of the nodes above the chunks of a skinned mesh's tree, from one box per child and joint. No vertex is posed for them.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::part_boxes::{PartBoxes, Parts};
use super::skin_tree::{MAX_REACH, SkinTree};
use crate::bounds::{Aabb, BoxLanes, Corners, LANES, with_simd};
use crate::joints::JointMatrices;
use crate::tree::{OuterGroup, OuterTables};

/// The boxes of the parts of the nodes above the chunks.
#[derive(Clone, Debug, Default)]
pub(super) struct OuterBoxes {
    /// By group above the chunks.
    groups: Vec<PartBoxes>,
}

impl OuterBoxes {
    pub(super) fn new(tables: &OuterTables) -> Self {
        Self {
            groups: vec![PartBoxes::default(); tables.group_count()],
        }
    }

    /// Sets `boxes` to boxes around the children of a group above the chunks, along the axes of the world and seen from `origin`.
    /// They contain every exact vertex.
    pub(super) fn compute(
        &mut self,
        tree: SkinTree<'_>,
        outer: usize,
        joints: &JointMatrices,
        origin: DVec3,
        boxes: &mut BoxLanes,
    ) {
        let group = &mut self.groups[outer];
        let of_tree = tree.skin.outer.group(outer);
        let tables = &tree.skin.outer.boxes;
        group.blend(tree.level, tables, &of_tree.blocks, tree.weights);
        match group.parts(tables, &of_tree.blocks) {
            Some(parts) => {
                let reach = joints.world_reach(parts.reach);
                with_simd!(tree.level, simd => bound(simd, of_tree, parts, joints, origin, reach, boxes));
            }
            None => boxes.set_all(&Aabb::UNBOUNDED),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.groups) + self.groups.iter().map(PartBoxes::bytes).sum::<usize>()
    }
}

/// Derived in docs/numerics.md, "Boxes above chunks".
#[inline(always)]
fn bound<S: Simd>(
    simd: S,
    group: &OuterGroup,
    parts: Parts<'_>,
    joints: &JointMatrices,
    origin: DVec3,
    reach: f64,
    boxes: &mut BoxLanes,
) {
    let zero = f64x4::splat(simd, 0.0);
    let far = origin.abs().max_element();
    let to_origin = f64x4::from_slice(simd, &[origin.x, origin.y, origin.z, 0.0]);
    // The world's origin, as seen from there.
    let origin = zero - to_origin;
    // Narrowing rounds by at most half of this share.
    let of_narrowing = f64x4::splat(simd, f64::from(f32::EPSILON));
    let roundings = (20.0 + 8.0 * group.most_parts as f64) * f64::EPSILON;
    let reach = reach + far;
    let mut corners = [Corners::default(); LANES];
    for ((joint_parts, [least, most]), corners) in group.children().zip(&mut corners) {
        // A child that no joint moves is at the world's origin.
        let (mut low, mut high) = (origin, origin);
        for (step, part) in joint_parts.iter().enumerate() {
            let (mut columns, index) = (joints.loaded(simd, part.joint), part.index as usize);
            columns[3] -= to_origin;
            let [middle, radius] = parts.block(index / LANES).image(simd, index, columns, 0.0);
            let (least, most) = (middle - radius, middle + radius);
            if step == 0 {
                (low, high) = (least, most);
            } else {
                let share = f64x4::splat(simd, f64::from(part.share));
                low += (least - low).min(zero) * share;
                high += (most - high).max(zero) * share;
            }
        }
        let mut reach = reach;
        let largest = f64::from(least.abs().max(most.abs()));
        if largest > 0.0 {
            let (least, most) = (
                f64x4::splat(simd, f64::from(least)),
                f64x4::splat(simd, f64::from(most)),
            );
            let (of_low, of_high) = (low - origin, high - origin);
            low -= (of_low * least).max(of_low * most);
            high -= (of_high * least).min(of_high * most);
            reach += largest * (reach + far);
        }
        let by = roundings * reach + f64::from(f32::MIN_POSITIVE);
        // False for NaN.
        if reach + by <= f64::from(MAX_REACH) {
            let by = f64x4::splat(simd, by);
            low -= low.abs() * of_narrowing + by;
            high += high.abs() * of_narrowing + by;
        } else {
            low = f64x4::splat(simd, f64::NEG_INFINITY);
            high = f64x4::splat(simd, f64::INFINITY);
        }
        low.narrow(high).store_slice(corners.as_flattened_mut());
    }
    boxes.set_corners(simd, &corners);
}
