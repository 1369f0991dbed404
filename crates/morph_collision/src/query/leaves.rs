//! The triangles of leaves in world space, cached for the duration of a query: a leaf meets several leaves of the other body.

use std::ops::Range;

use glam::Vec3;

use crate::bounds::{LANES, Lanes, WorldFromModel};
use crate::exact::Triangle;
use crate::pose::Posed;
use crate::tree::{CornerLanes, Leaf};

/// The leaves of a body that a query has read, and the block of each.
#[derive(Debug, Default)]
pub(super) struct LeafStamps {
    /// Per leaf: the last query that read it, and its block then.
    stamps: Vec<(u32, u32)>,
    query: u32,
}

impl LeafStamps {
    /// Starts a query on a tree with this many leaves.
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

    /// The block of a leaf, if this query has read it.
    #[inline]
    pub(super) fn find(&self, leaf: Leaf) -> Option<usize> {
        let (query, block) = self.stamps[leaf.0];
        (query == self.query).then_some(block as usize)
    }

    pub(super) fn insert(&mut self, leaf: Leaf, block: usize) {
        self.stamps[leaf.0] = (self.query, block as u32);
    }
}

/// The triangles of the leaves of one body that a query has read, in world space. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct Leaves {
    stamps: LeafStamps,
    /// Each block's range of `placed`.
    blocks: Vec<Range<usize>>,
    placed: Vec<(u32, Triangle)>,
    /// Scratch memory of `read`.
    posed: Vec<CornerLanes>,
}

impl Leaves {
    /// Starts a query on a tree with this many leaves.
    pub(super) fn begin(&mut self, leaves: usize) {
        self.stamps.begin(leaves);
        self.blocks.clear();
        self.placed.clear();
    }

    /// The block of a leaf. Blends and places its triangles on the first call.
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

    /// The triangles of a block, each with its number.
    pub(super) fn triangles(&self, block: Range<usize>) -> &[(u32, Triangle)] {
        &self.placed[block]
    }
}

/// Appends a leaf's triangles to `placed`, each with its number and its corners in world space. `posed` is scratch memory.
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
