//! Boxes around vertices before joints move them: those that no target moves, which are the same in all poses, and tables for the others.

use std::ops::Range;

use fearless_simd::Level;

use super::extents::NodeExtents;
use super::tables::{GroupTables, Tables};
use crate::bounds::{BoxLanes, CenteredLanes, LANES, with_simd};

/// Boxes around the vertices that a joint moves, before it moves them, eight side by side.
#[derive(Clone, Default)]
pub(crate) struct PartTables {
    /// Those that no target moves. They need no widening: such vertices are exactly those of the mesh.
    still: Vec<CenteredLanes>,
    /// Those that have to be blended. In a block, some of them may be still.
    moved: Tables,
}

/// Boxes that are used together.
#[derive(Clone, Debug, Default)]
pub(crate) struct PartBlocks {
    still: Range<usize>,
    moved: Range<usize>,
    /// A bound on the absolute coordinates of the still ones.
    pub(crate) still_reach: f32,
}

impl PartBlocks {
    /// The number of blocks that have to be blended.
    #[inline(always)]
    pub(crate) fn moved_count(&self) -> usize {
        self.moved.len()
    }
}

impl PartTables {
    /// Adds boxes, eight to a block. Those that no target moves must come first.
    pub(super) fn add(&mut self, parts: &[NodeExtents]) -> PartBlocks {
        let mut blocks = PartBlocks {
            still: self.still.len()..self.still.len(),
            moved: self.moved.group_count()..self.moved.group_count(),
            still_reach: 0.0,
        };
        for parts in parts.chunks(LANES) {
            let whole = NodeExtents::of_parts(parts.iter());
            if whole.targets.is_empty() {
                let mut boxes = BoxLanes::default();
                for (lane, part) in parts.iter().enumerate() {
                    boxes.set(lane, &part.base.outward());
                }
                let mut centered = CenteredLanes::default();
                with_simd!(Level::baseline(), simd => centered.set(simd, &boxes));
                self.still.push(centered);
                // The conversion is exact: it is a coordinate of the mesh.
                blocks.still_reach = blocks.still_reach.max(whole.base.reach() as f32);
            } else {
                let block = self.moved.group_count();
                self.moved.reserve();
                self.moved.fill(block, parts, &whole);
            }
        }
        blocks.still.end = self.still.len();
        blocks.moved.end = self.moved.group_count();
        blocks
    }

    pub(super) fn finish(&mut self) {
        self.still.shrink_to_fit();
        self.moved.finish();
    }

    /// The boxes that no target moves.
    #[inline(always)]
    pub(crate) fn still(&self, blocks: &PartBlocks) -> &[CenteredLanes] {
        &self.still[blocks.still.clone()]
    }

    /// The tables of the others, block by block.
    #[inline(always)]
    pub(crate) fn moved(&self, blocks: &PartBlocks) -> impl Iterator<Item = GroupTables<'_>> {
        blocks.moved.clone().map(|block| self.moved.group(block))
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.still) + self.moved.bytes()
    }
}
