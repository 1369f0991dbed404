//! The vertices of a mesh without joints in one pose, blended eight at a time when a query first needs one of them.

use fearless_simd::{Level, Simd};

use super::stamps::Stamps;
use crate::bounds::with_simd;
use crate::model::{BLOCK, BlendedBlock, MorphModel, Weights};

/// Vertices before placement, in blocks of eight. The memory is reserved when the first one is blended.
#[derive(Clone, Debug)]
pub(super) struct BlendedVertices {
    blocks: Stamps,
    points: Vec<BlendedBlock>,
}

impl BlendedVertices {
    pub(super) fn new() -> Self {
        Self {
            blocks: Stamps::new(),
            points: Vec::new(),
        }
    }

    /// Discards all positions and keeps the memory.
    pub(super) fn discard(&mut self) {
        self.blocks.discard();
    }

    /// Blends a block unless that has happened already. Returns the number of vertices that were blended.
    #[inline(always)]
    pub(super) fn blend(&mut self, level: Level, model: &MorphModel, block: usize, weights: &Weights) -> u64 {
        if self.blocks.is_valid(block) {
            return 0;
        }
        self.blend_block(level, model, block, weights)
    }

    #[inline(never)]
    fn blend_block(&mut self, level: Level, model: &MorphModel, block: usize, weights: &Weights) -> u64 {
        self.reserve(model);
        with_simd!(level, simd => self.blend_unless_valid(simd, model, block, weights))
    }

    /// Blends all blocks that are not blended yet. Returns the number of vertices that were blended.
    #[inline(always)]
    pub(super) fn blend_all<S: Simd>(&mut self, simd: S, model: &MorphModel, weights: &Weights) -> u64 {
        self.reserve(model);
        let mut blended = 0;
        // Not a closure, which may lose the instruction set.
        for block in 0..model.block_count() {
            blended += self.blend_unless_valid(simd, model, block, weights);
        }
        blended
    }

    #[inline(always)]
    fn blend_unless_valid<S: Simd>(&mut self, simd: S, model: &MorphModel, block: usize, weights: &Weights) -> u64 {
        if !self.blocks.claim(block) {
            return 0;
        }
        model.blend_points(simd, block, weights, &mut self.points[block]);
        model.block_len(block) as u64
    }

    fn reserve(&mut self, model: &MorphModel) {
        if self.points.is_empty() {
            self.blocks.reset(model.block_count());
            self.points = vec![[[0.0; 4]; BLOCK]; model.block_count()];
        }
    }

    /// Positions by vertex. Those of blocks that are not blended are meaningless.
    #[inline(always)]
    pub(super) fn points(&self) -> &[[f32; 4]] {
        self.points.as_flattened()
    }

    pub(super) fn bytes(&self) -> usize {
        self.blocks.bytes() + size_of_val(&*self.points)
    }
}
