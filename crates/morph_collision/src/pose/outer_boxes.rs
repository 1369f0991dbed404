//! Boxes of the nodes above the chunks of a skinned mesh's tree, from one box per child and joint. No vertex is posed for them.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::part_boxes::{PartBoxes, Parts};
use super::skin_tree::{MAX_REACH, SkinTree};
use crate::bounds::{Aabb, BoxLanes, Corners, LANES, MapFrame, WorldFromModel, with_simd};
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

    /// Sets `boxes` to boxes around the children of a group above the chunks, in a space. They contain every exact vertex.
    pub(super) fn compute(
        &mut self,
        tree: SkinTree<'_>,
        outer: usize,
        joints: &JointMatrices,
        space: &impl Space,
        boxes: &mut BoxLanes,
    ) {
        let group = &mut self.groups[outer];
        let of_tree = tree.skin.outer.group(outer);
        let tables = &tree.skin.outer.boxes;
        group.blend(tree.level, tables, &of_tree.blocks, tree.weights);
        match group.parts(tables, &of_tree.blocks) {
            Some(parts) => {
                let reach = joints.world_reach(parts.reach);
                with_simd!(tree.level, simd => bound(simd, of_tree, parts, joints, space, reach, boxes));
            }
            None => boxes.set_all(&Aabb::UNBOUNDED),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.groups) + self.groups.iter().map(PartBoxes::bytes).sum::<usize>()
    }
}

/// A space in which the children of groups above the chunks are bounded.
pub(super) trait Space {
    /// The world's origin in the space.
    fn origin(&self) -> DVec3;

    /// The largest absolute coordinate of the space's origin in the world.
    fn far(&self) -> f64;

    /// The columns of a joint's matrix, as seen in the space.
    fn joint<S: Simd>(&self, simd: S, joints: &JointMatrices, joint: u16) -> [f64x4<S>; 4];

    /// A bound on the error of a box, given that of world coordinates up to `reach`. Infinite if the space has no inverse.
    fn rounding(&self, error: f64, reach: f64) -> DVec3;
}

/// The axes of the world, and this origin.
impl Space for DVec3 {
    #[inline(always)]
    fn origin(&self) -> DVec3 {
        -*self
    }

    #[inline(always)]
    fn far(&self) -> f64 {
        self.abs().max_element()
    }

    #[inline(always)]
    fn joint<S: Simd>(&self, simd: S, joints: &JointMatrices, joint: u16) -> [f64x4<S>; 4] {
        let mut columns = joints.loaded(simd, joint);
        columns[3] -= f64x4::from_slice(simd, &[self.x, self.y, self.z, 0.0]);
        columns
    }

    #[inline(always)]
    fn rounding(&self, error: f64, _: f64) -> DVec3 {
        DVec3::splat(error)
    }
}

/// The model space of an entity, for boxes that also allow for the error of vertices in the world.
pub(super) struct EntitySpace<'a> {
    pub(super) place: &'a WorldFromModel,
    pub(super) frame: MapFrame,
    pub(super) error: f64,
}

impl Space for EntitySpace<'_> {
    fn origin(&self) -> DVec3 {
        self.place.model_origin()
    }

    fn far(&self) -> f64 {
        self.place.translation().abs().max_element()
    }

    #[inline(always)]
    fn joint<S: Simd>(&self, simd: S, joints: &JointMatrices, joint: u16) -> [f64x4<S>; 4] {
        self.frame.joint(simd, joints.padded(joint))
    }

    fn rounding(&self, error: f64, reach: f64) -> DVec3 {
        let rounding = self.place.model_error(reach, self.error + error);
        // Coordinates in the space are at most the first of these numbers.
        let is_bounded = |by: &DVec3| by.max_element() / (16.0 * f64::EPSILON) <= f64::from(MAX_REACH);
        rounding.filter(is_bounded).unwrap_or(DVec3::INFINITY)
    }
}

/// Derived in docs/numerics.md, "Boxes above chunks".
#[inline(always)]
fn bound<S: Simd>(
    simd: S,
    group: &OuterGroup,
    parts: Parts<'_>,
    joints: &JointMatrices,
    space: &impl Space,
    reach: f64,
    boxes: &mut BoxLanes,
) {
    let zero = f64x4::splat(simd, 0.0);
    let DVec3 { x, y, z } = space.origin();
    let origin = f64x4::from_slice(simd, &[x, y, z, 0.0]);
    // Narrowing rounds by at most half of this share.
    let of_narrowing = f64x4::splat(simd, f64::from(f32::EPSILON));
    let roundings = (20.0 + 8.0 * group.most_parts as f64) * f64::EPSILON;
    let (far, reach) = (space.far(), reach + space.far());
    let mut corners = [Corners::default(); LANES];
    for ((joint_parts, [least, most]), corners) in group.children().zip(&mut corners) {
        // A child that no joint moves is at the world's origin.
        let (mut low, mut high) = (origin, origin);
        for (step, part) in joint_parts.iter().enumerate() {
            let (columns, index) = (space.joint(simd, joints, part.joint), part.index as usize);
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
        let by = space.rounding(roundings * reach, reach) + f64::from(f32::MIN_POSITIVE);
        // False for NaN.
        if reach + by.max_element() <= f64::from(MAX_REACH) {
            let by = f64x4::from_slice(simd, &[by.x, by.y, by.z, 0.0]);
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
