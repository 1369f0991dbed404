//! Boxes around the vertices that joints move, blended for a pose's weights, before joints move them.

use fearless_simd::{Level, Simd};

use super::blend::blend_group;
use super::skin_tree::MAX_REACH;
use crate::bounds::{BoxLanes, CenteredLanes, with_simd};
use crate::model::Weights;
use crate::tree::{GroupTables, PartBlocks, PartTables};

/// The boxes of some blocks that targets move, blended for a pose's weights. The tree has the others.
#[derive(Clone, Debug, Default)]
pub(super) struct PartBoxes {
    moved: Vec<CenteredLanes>,
    /// A bound on the absolute coordinates of all boxes.
    reach: f32,
    /// For which of the pose's weights they are valid; 0 for none.
    version: u64,
}

/// Boxes of parts, eight to a block.
#[derive(Clone, Copy)]
pub(super) struct Parts<'a> {
    /// Those that no target moves come first.
    pub(super) still: &'a [CenteredLanes],
    pub(super) moved: &'a [CenteredLanes],
    /// A bound on the absolute coordinates of all boxes.
    pub(super) reach: f64,
}

impl<'a> Parts<'a> {
    #[inline(always)]
    pub(super) fn block(&self, block: usize) -> &'a CenteredLanes {
        match block.checked_sub(self.still.len()) {
            None => &self.still[block],
            Some(moved) => &self.moved[moved],
        }
    }

    /// All blocks.
    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = &'a CenteredLanes> {
        self.still.iter().chain(self.moved)
    }
}

impl PartBoxes {
    /// Blends the boxes of these blocks unless they are valid for these weights.
    pub(super) fn blend(&mut self, level: Level, tables: &PartTables, blocks: &PartBlocks, weights: &Weights) {
        if std::mem::replace(&mut self.version, weights.version()) == weights.version() {
            return;
        }
        if self.moved.is_empty() {
            self.moved.reserve_exact(blocks.moved_count());
            self.moved.resize_with(blocks.moved_count(), CenteredLanes::default);
        }
        self.reach = blocks.still_reach;
        for (boxes, tables) in self.moved.iter_mut().zip(tables.moved(blocks)) {
            let reach = with_simd!(level, simd => blend(simd, tables, weights, boxes));
            self.reach = self.reach.max(reach);
        }
    }

    /// The boxes of the blocks that were blended last; `None` if coordinates are too large to compute with.
    #[inline(always)]
    pub(super) fn parts<'a>(&'a self, tables: &'a PartTables, blocks: &PartBlocks) -> Option<Parts<'a>> {
        // False for NaN.
        (self.reach <= MAX_REACH).then(|| Parts {
            still: tables.still(blocks),
            moved: &self.moved,
            reach: f64::from(self.reach),
        })
    }

    pub(super) fn bytes(&self) -> usize {
        self.moved.capacity() * size_of::<CenteredLanes>()
    }
}

/// Returns a bound on the boxes' absolute coordinates.
#[inline(always)]
fn blend<S: Simd>(simd: S, tables: GroupTables<'_>, weights: &Weights, centered: &mut CenteredLanes) -> f32 {
    let mut boxes = BoxLanes::default();
    let reach = blend_group(simd, tables, weights, &mut boxes);
    centered.set(simd, &boxes);
    reach
}
