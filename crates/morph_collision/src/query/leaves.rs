//! The triangles of leaves in world space, kept for the time of a query: a leaf meets several of the other body's.

use std::ops::Range;

use glam::Vec3;

use crate::bounds::{LANES, Lanes, WorldFromModel};
use crate::exact::Triangle;
use crate::pose::Posed;
use crate::tree::{CornerLanes, Leaf};

/// Which leaves of a body a query has read, and as which of its blocks.
#[derive(Debug, Default)]
pub(super) struct LeafStamps {
    /// Per leaf: the query that read it last, and the block it is in that one.
    stamps: Vec<(u32, u32)>,
    query: u32,
}

impl LeafStamps {
    /// Forgets the query before; there are so many leaves.
    pub(super) fn begin(&mut self, leaves: usize) {
        self.query = self.query.wrapping_add(1);
        if self.query == 0 {
            self.stamps.fill((0, 0));
            self.query = 1;
        }
        if self.stamps.len() < leaves {
            self.stamps.resize(leaves, (0, 0));
        }
    }

    /// The block of a leaf that was read.
    #[inline]
    pub(super) fn find(&self, leaf: Leaf) -> Option<usize> {
        let (query, block) = self.stamps[leaf.0];
        (query == self.query).then_some(block as usize)
    }

    pub(super) fn insert(&mut self, leaf: Leaf, block: usize) {
        self.stamps[leaf.0] = (self.query, block as u32);
    }
}

/// The triangles of the leaves of one body that a query has read, placed in the world; the memory is reused by the next query.
#[derive(Debug, Default)]
pub(super) struct Leaves {
    stamps: LeafStamps,
    /// Where each block's triangles are among `placed`.
    blocks: Vec<Range<usize>>,
    placed: Vec<(u32, Triangle)>,
    /// Of the leaf that is being read.
    posed: Vec<CornerLanes>,
}

impl Leaves {
    /// Forgets the leaves of the query before; there are so many.
    pub(super) fn begin(&mut self, leaves: usize) {
        self.stamps.begin(leaves);
        self.blocks.clear();
        self.placed.clear();
    }

    /// Where a leaf's triangles are; they are blended and placed at the first call.
    pub(super) fn read(&mut self, tree: &mut Posed<'_>, world_from_model: &WorldFromModel, leaf: Leaf) -> Range<usize> {
        if let Some(block) = self.stamps.find(leaf) {
            return self.blocks[block].clone();
        }
        let start = self.placed.len();
        place_leaf(tree, world_from_model, leaf, &mut self.posed, &mut self.placed);
        let block = start..self.placed.len();
        self.stamps.insert(leaf, self.blocks.len());
        self.blocks.push(block.clone());
        block
    }

    /// Triangles that were read, each with its number.
    pub(super) fn triangles(&self, block: Range<usize>) -> &[(u32, Triangle)] {
        &self.placed[block]
    }
}

/// Appends a leaf's triangles to `placed`, each with its number and its corners in world space; `posed` is scratch memory.
pub(super) fn place_leaf(
    tree: &mut Posed<'_>,
    world_from_model: &WorldFromModel,
    leaf: Leaf,
    posed: &mut Vec<CornerLanes>,
    placed: &mut Vec<(u32, Triangle)>,
) {
    posed.clear();
    tree.leaf_corners(leaf, posed);
    let numbers = tree.topology.leaf_triangles(leaf);
    for (corners, numbers) in posed.iter().zip(numbers.chunks(LANES)) {
        let triangles = numbers.iter().enumerate();
        placed.extend(triangles.map(|(lane, &number)| (number, placed_triangle(corners, lane, world_from_model))));
    }
}

/// The corners of a triangle of a patch in world space.
#[inline(always)]
pub(super) fn placed_triangle(posed: &CornerLanes, lane: usize, world_from_model: &WorldFromModel) -> Triangle {
    let lane = lane % LANES;
    let corner = |[x, y, z]: &[Lanes; 3]| {
        let posed = Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
        world_from_model.transform_point(posed)
    };
    let [a, b, c] = posed;
    [corner(a), corner(b), corner(c)]
}
