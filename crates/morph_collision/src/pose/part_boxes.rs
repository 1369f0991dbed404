//! Boxes around the vertices that joints move, blended for a pose's weights, before joints move them.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x4};
use glam::DVec3;

use super::blend::blend_group;
use super::skin_tree::MAX_REACH;
use crate::bounds::{Box64, BoxLanes, LANES, with_simd};
use crate::model::Weights;
use crate::tree::{GroupTables, Tables};

/// Eight boxes side by side, by their centres and half sizes.
#[derive(Clone, Debug, Default)]
pub(super) struct PartBlock {
    pub(super) center: [[f64; LANES]; 3],
    pub(super) half: [[f64; LANES]; 3],
    /// A bound on the boxes' absolute coordinates.
    reach: f32,
}

/// Boxes around vertices before joints move them, eight side by side.
#[derive(Clone, Debug, Default)]
pub(super) struct PartBoxes {
    blocks: Vec<PartBlock>,
    /// The number of blocks before the first one that a target moves.
    still: usize,
    /// A bound on the absolute coordinates of these.
    still_reach: f32,
    /// A bound on those of all boxes.
    reach: f32,
    /// For which of the pose's weights they are valid; 0 for none.
    version: u64,
}

impl PartBoxes {
    /// Blends the boxes of these groups of tables unless they are valid for these weights. Groups without targets are blended only once.
    pub(super) fn blend(&mut self, level: Level, tables: &Tables, groups: Range<usize>, weights: &Weights) {
        if std::mem::replace(&mut self.version, weights.version()) == weights.version() {
            return;
        }
        self.blocks
            .reserve_exact(groups.len().saturating_sub(self.blocks.len()));
        self.reach = self.still_reach;
        for index in self.still..groups.len() {
            let tables = tables.group(groups.start + index);
            let is_new = index == self.blocks.len();
            if is_new {
                self.blocks.push(PartBlock::default());
            }
            let (block, is_moved) = (&mut self.blocks[index], !tables.targets.is_empty());
            if is_new || is_moved {
                with_simd!(level, simd => block.blend(simd, tables, weights));
            }
            self.reach = self.reach.max(block.reach);
            if index == self.still && !is_moved {
                (self.still, self.still_reach) = (index + 1, self.reach);
            }
        }
    }

    /// The blended boxes; `None` if coordinates are too large to compute with.
    pub(super) fn blocks(&self) -> Option<&[PartBlock]> {
        // False for NaN.
        (self.reach <= MAX_REACH).then_some(&self.blocks)
    }

    pub(super) fn reach(&self) -> f64 {
        f64::from(self.reach)
    }

    pub(super) fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<PartBlock>()
    }
}

impl PartBlock {
    #[inline(always)]
    fn blend<S: Simd>(&mut self, simd: S, tables: GroupTables<'_>, weights: &Weights) {
        let mut boxes = BoxLanes::default();
        self.reach = blend_group(simd, tables, weights, &mut boxes);
        let by_two = f64x4::splat(simd, 0.5);
        for axis in 0..3 {
            let (min, high_min) = boxes.min[axis].load(simd).widen();
            let (max, high_max) = boxes.max[axis].load(simd).widen();
            let (center, high_center) = self.center[axis].split_at_mut(LANES / 2);
            ((min + max) * by_two).store_slice(center);
            ((high_min + high_max) * by_two).store_slice(high_center);
            let (half, high_half) = self.half[axis].split_at_mut(LANES / 2);
            ((max - min) * by_two).store_slice(half);
            ((high_max - high_min) * by_two).store_slice(high_half);
        }
    }

    pub(super) fn get(&self, lane: usize) -> Box64 {
        let of = |[x, y, z]: &[[f64; LANES]; 3]| DVec3::new(x[lane], y[lane], z[lane]);
        Box64 {
            center: of(&self.center),
            half: of(&self.half),
        }
    }

    /// The middle of a box's image under a map with these columns, and how far the image reaches from it.
    #[inline(always)]
    pub(super) fn image<S: Simd>(&self, simd: S, lane: usize, [x, y, z, offset]: [f64x4<S>; 4]) -> [f64x4<S>; 2] {
        let lane = lane % LANES;
        let (mut middle, mut radius) = (offset, f64x4::splat(simd, 0.0));
        for ((column, center), half) in [x, y, z].into_iter().zip(&self.center).zip(&self.half) {
            middle += column * f64x4::splat(simd, center[lane]);
            radius += column.abs() * f64x4::splat(simd, half[lane]);
        }
        [middle, radius]
    }
}
