//! The vertices of a skinned mesh in one pose, posed eight at a time when a query first needs one of them.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::skin_tree::SkinTree;
use super::stamps::Stamps;
use crate::bounds::with_simd;
use crate::joints::JointMatrices;
use crate::model::{BLOCK, PlacedBlock};

/// Posed vertices, in blocks of eight. The memory is reserved when the first one is posed.
#[derive(Clone, Debug)]
pub(super) struct PosedVertices {
    blocks: Stamps,
    /// Chunks of which all blocks are posed.
    chunks: Stamps,
    /// World positions. The fourth number is padding.
    world: Vec<PlacedBlock>,
    /// The same relative to the origin of the body's frame, rounded to the nearest `f32`.
    local: Vec<[[f32; 4]; BLOCK]>,
}

impl PosedVertices {
    pub(super) fn new() -> Self {
        Self {
            blocks: Stamps::new(),
            chunks: Stamps::new(),
            world: Vec::new(),
            local: Vec::new(),
        }
    }

    /// Discards all positions and keeps the memory.
    pub(super) fn invalidate(&mut self) {
        self.blocks.discard();
        self.chunks.discard();
    }

    /// Poses the blocks of a chunk unless they are posed already. Returns the number of vertices that were posed.
    #[inline(always)]
    pub(super) fn pose_chunk(
        &mut self,
        tree: SkinTree<'_>,
        joints: &JointMatrices,
        origin: DVec3,
        chunk: usize,
    ) -> u64 {
        if self.chunks.is_valid(chunk) {
            return 0;
        }
        self.pose_blocks_of(tree, joints, origin, chunk)
    }

    #[inline(never)]
    fn pose_blocks_of(&mut self, tree: SkinTree<'_>, joints: &JointMatrices, origin: DVec3, chunk: usize) -> u64 {
        let mut posed = 0;
        with_simd!(tree.level, simd => {
            for &block in tree.skin.chunks.blocks(chunk) {
                posed += self.pose(simd, tree, joints, origin, block as usize);
            }
        });
        self.chunks.claim(chunk);
        posed
    }

    /// Poses all blocks that are not posed yet. Returns the number of vertices that were posed.
    #[inline(always)]
    pub(super) fn pose_all<S: Simd>(
        &mut self,
        simd: S,
        tree: SkinTree<'_>,
        joints: &JointMatrices,
        origin: DVec3,
    ) -> u64 {
        let mut posed = 0;
        for block in 0..tree.model.block_count() {
            posed += self.pose(simd, tree, joints, origin, block);
        }
        for chunk in 0..tree.skin.chunks.len() {
            self.chunks.claim(chunk);
        }
        posed
    }

    /// Poses a block unless it is posed already. Returns the number of vertices that were posed.
    #[inline(always)]
    pub(super) fn pose<S: Simd>(
        &mut self,
        simd: S,
        tree: SkinTree<'_>,
        joints: &JointMatrices,
        origin: DVec3,
        block: usize,
    ) -> u64 {
        if self.world.is_empty() {
            self.reserve(tree.model.block_count(), tree.skin.chunks.len());
        }
        if !self.blocks.claim(block) {
            return 0;
        }
        let Some(skin) = tree.model.skin() else { return 0 };
        let (world, local) = (&mut self.world[block], &mut self.local[block]);
        let positions = tree.model.blend_block(simd, block, tree.weights);
        skin.place_block(simd, block, positions, joints, world);
        let origin = f64x4::from_slice(simd, &[origin.x, origin.y, origin.z, 0.0]);
        let pairs = local.as_flattened_mut().chunks_exact_mut(8);
        let (worlds, _) = world.as_chunks::<2>();
        for ([a, b], pair) in worlds.iter().zip(pairs) {
            let (a, b) = (f64x4::from_slice(simd, a) - origin, f64x4::from_slice(simd, b) - origin);
            a.narrow(b).store_slice(pair);
        }
        tree.model.block_len(block) as u64
    }

    #[cold]
    fn reserve(&mut self, blocks: usize, chunks: usize) {
        self.blocks.reset(blocks);
        self.chunks.reset(chunks);
        self.world = vec![[[0.0; 4]; BLOCK]; blocks];
        self.local = vec![[[0.0; 4]; BLOCK]; blocks];
    }

    /// World positions by vertex. Those of blocks that are not posed are meaningless.
    #[inline(always)]
    pub(super) fn world(&self) -> &[[f64; 4]] {
        self.world.as_flattened()
    }

    /// Positions relative to the origin of the body's frame, by vertex.
    #[inline(always)]
    pub(super) fn local(&self) -> &[[f32; 4]] {
        self.local.as_flattened()
    }

    pub(super) fn bytes(&self) -> usize {
        self.blocks.bytes() + self.chunks.bytes() + size_of_val(&*self.world) + size_of_val(&*self.local)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Affine3A, Vec3};

    use crate::{BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, Pose};

    #[test]
    fn old_vertices_stay_forgotten_when_the_epoch_wraps() {
        let influences = Influences {
            joints: &[[0; 4]; 3],
            weights: &[[1.0, 0.0, 0.0, 0.0]; 3],
        };
        let no_targets: [Vec<Vec3>; 0] = [];
        let model = MorphModel::skinned(&Vec3::AXES, &[[0, 1, 2]], &no_targets, 1, &[influences]).unwrap();
        let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
        let set_epoch = |pose: &mut Pose, epoch| {
            let (_, skinning) = pose.skinning.as_mut().unwrap();
            skinning.vertices.blocks.epoch = epoch;
        };
        set_epoch(&mut pose, 1);
        assert_eq!(pose.vertex(0), Some(Vec3::X));
        // The epoch wraps around to the number under which this position was stored.
        set_epoch(&mut pose, u32::MAX);
        let joint = Affine3A::from_translation(Vec3::Y);
        pose.set_joints(&JointMatrices::new(&[joint]).unwrap()).unwrap();
        assert_eq!(pose.vertex(0), Some(Vec3::new(1.0, 1.0, 0.0)));
    }
}
