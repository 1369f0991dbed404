//! Blocks of eight consecutive vertices, which are posed side by side.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::Vec3;

/// The number of vertices in a block. Vertex `v` is in lane `v % BLOCK` of block `v / BLOCK`. Only the last block may have fewer
/// vertices; its other lanes repeat the last vertex.
pub(crate) const BLOCK: usize = 8;

/// A vector per vertex of a block, by coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BlockVectors([[f32; BLOCK]; 3]);

impl BlockVectors {
    /// The vectors of up to eight items. The other lanes repeat the last one.
    pub(super) fn new<T>(items: &[T], vector: impl Fn(&T) -> Vec3) -> Self {
        let mut vectors = Self::default();
        for (lane, item) in repeated(items) {
            for (row, coordinate) in vectors.0.iter_mut().zip(vector(item).to_array()) {
                row[lane] = coordinate;
            }
        }
        vectors
    }

    #[inline(always)]
    pub(super) fn of(&self, lane: usize) -> Vec3 {
        Vec3::from(self.0.map(|row| row[lane % BLOCK]))
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S) -> [f32x8<S>; 3] {
        let [x, y, z] = &self.0;
        [
            f32x8::from_slice(simd, x),
            f32x8::from_slice(simd, y),
            f32x8::from_slice(simd, z),
        ]
    }
}

/// Pairs every lane of a block with an item. Lanes beyond the last item repeat it.
pub(super) fn repeated<T>(items: &[T]) -> impl Iterator<Item = (usize, &T)> {
    (0..BLOCK).zip(items.iter().chain(items.last().into_iter().cycle()))
}

/// The block of a vertex, and its lane there.
#[inline(always)]
pub(crate) fn block_and_lane(vertex: u32) -> (usize, usize) {
    (vertex as usize / BLOCK, vertex as usize % BLOCK)
}
