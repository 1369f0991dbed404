//! The displacements of targets, as callers pass them: dense or sparse.

use glam::Vec3;

/// The displacements of one target, one per vertex of the base: a slice, a vector or an array of them, or a [`SparseTarget`].
///
/// You cannot implement this trait.
pub trait TargetDisplacements: sealed::Sealed {}

impl<T: sealed::Sealed> TargetDisplacements for T {}

pub(super) mod sealed {
    use glam::Vec3;

    pub trait Sealed {
        /// The number of vertices.
        fn vertex_count(&self) -> usize;

        /// The stored displacements. All others are zero.
        fn stored(&self) -> &[Vec3];

        /// The vertex of a stored displacement.
        fn vertex_of(&self, stored: usize) -> usize;

        /// The displacement of a vertex.
        fn of(&self, vertex: usize) -> Vec3;
    }
}

impl<T: AsRef<[Vec3]>> sealed::Sealed for T {
    fn vertex_count(&self) -> usize {
        self.as_ref().len()
    }

    fn stored(&self) -> &[Vec3] {
        self.as_ref()
    }

    fn vertex_of(&self, stored: usize) -> usize {
        stored
    }

    #[inline]
    fn of(&self, vertex: usize) -> Vec3 {
        self.as_ref()[vertex]
    }
}

/// The displacements of one target without those that are zero. Use it to build models with less memory: a face's targets move only a
/// part of its vertices each.
///
/// Displacements are added vertex by vertex, from the first one on. Memory: 12 bytes per displacement that is not zero,
/// and two bits per vertex.
///
/// ```
/// # use glam::Vec3;
/// # use morph_collision::{MorphModel, SparseTarget};
/// let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// let target: SparseTarget = [Vec3::ZERO, Vec3::ZERO, Vec3::Z].into_iter().collect();
/// assert_eq!((target.len(), target.stored_count()), (3, 1));
/// let model = MorphModel::from_displacements(&base, &[[0, 1, 2]], &[target])?;
/// assert_eq!(model.displaced_vertex_count(0), 1);
/// # Ok::<(), morph_collision::ModelError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseTarget {
    len: usize,
    blocks: Vec<Block>,
    /// Those that are not zero, in the order of their vertices.
    displacements: Vec<Vec3>,
}

/// The displacements of 32 vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    /// Where they start in `displacements`.
    start: u32,
    /// A bit mask of the vertices that move.
    moved: u32,
}

/// The block of a vertex, and its bit in it.
fn block_and_bit(vertex: usize) -> (usize, u32) {
    (vertex / 32, 1 << (vertex % 32))
}

impl SparseTarget {
    /// The number of vertices, moved or not.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no vertices.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The number of vertices that the target moves.
    #[must_use]
    pub fn stored_count(&self) -> usize {
        self.displacements.len()
    }

    /// Releases memory that was reserved for more vertices.
    pub fn shrink_to_fit(&mut self) {
        self.blocks.shrink_to_fit();
        self.displacements.shrink_to_fit();
    }
}

impl Extend<Vec3> for SparseTarget {
    /// Adds the displacements of the next vertices.
    fn extend<I: IntoIterator<Item = Vec3>>(&mut self, displacements: I) {
        for displacement in displacements {
            let (block, bit) = block_and_bit(self.len);
            if block == self.blocks.len() {
                self.blocks.push(Block {
                    start: self.displacements.len() as u32,
                    moved: 0,
                });
            }
            if displacement != Vec3::ZERO {
                self.blocks[block].moved |= bit;
                self.displacements.push(displacement);
            }
            self.len += 1;
        }
    }
}

impl FromIterator<Vec3> for SparseTarget {
    fn from_iter<I: IntoIterator<Item = Vec3>>(displacements: I) -> Self {
        let mut target = Self::default();
        target.extend(displacements);
        target
    }
}

impl sealed::Sealed for SparseTarget {
    fn vertex_count(&self) -> usize {
        self.len
    }

    fn stored(&self) -> &[Vec3] {
        &self.displacements
    }

    fn vertex_of(&self, stored: usize) -> usize {
        let is_at_most = |block: &Block| block.start as usize <= stored;
        // The last of these blocks is not empty: the next one starts behind `stored`.
        let number = self.blocks.partition_point(is_at_most).saturating_sub(1);
        let Block { start, moved } = self.blocks[number];
        let mut vertices = (0..32).filter(|vertex| moved >> vertex & 1 == 1);
        32 * number + vertices.nth(stored - start as usize).unwrap_or_default()
    }

    #[inline]
    fn of(&self, vertex: usize) -> Vec3 {
        let (block, bit) = block_and_bit(vertex);
        let Block { start, moved } = self.blocks[block];
        if moved & bit == 0 {
            return Vec3::ZERO;
        }
        self.displacements[start as usize + (moved & (bit - 1)).count_ones() as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::sealed::Sealed;
    use super::*;

    #[test]
    fn a_sparse_target_is_what_it_was_made_of() {
        // Long runs of both kinds, and blocks in which nothing moves.
        let moves = |vertex: usize| vertex % 97 < 20 || vertex.is_multiple_of(7) && vertex < 50;
        let dense: Vec<Vec3> = (0..400)
            .map(|vertex| {
                if moves(vertex) {
                    Vec3::splat(vertex as f32 + 1.0)
                } else {
                    Vec3::ZERO
                }
            })
            .collect();
        let mut sparse = SparseTarget::default();
        for part in dense.chunks(45) {
            sparse.extend(part.iter().copied());
        }
        assert_eq!(sparse, dense.iter().copied().collect());
        assert_eq!((sparse.len(), sparse.vertex_count()), (400, 400));
        for (vertex, displacement) in dense.iter().enumerate() {
            assert_eq!(sparse.of(vertex), *displacement, "{vertex}");
        }
        let moved: Vec<usize> = (0..400).filter(|&vertex| moves(vertex)).collect();
        assert_eq!(sparse.stored_count(), moved.len());
        let stored: Vec<usize> = (0..moved.len()).map(|stored| sparse.vertex_of(stored)).collect();
        assert_eq!(stored, moved);
    }
}
