//! The triangles of leaves in world space, kept for the time of a query: a leaf meets several of the other body's.

use std::ops::{ControlFlow, Range};

use glam::DVec3;

use super::body::world_triangle;
use super::pairs::TrianglePair;
use crate::bounds::{BoxLanes, LANES, Slab, Volume, WorldFromModel};
use crate::exact::{Triangle, triangles_intersect_counting};
use crate::traverse::Walkable;
use crate::tree::Leaf;

/// The leaves of one body that a query has read; the memory is reused by the next query.
#[derive(Debug, Default)]
pub(super) struct Leaves {
    /// Per leaf: the query that read it last, and which of `blocks` it is in that one.
    stamps: Vec<(u32, u32)>,
    query: u32,
    /// Boxes are relative to this point of world space, near both bodies.
    origin: DVec3,
    blocks: Vec<Block>,
    numbers: Vec<u32>,
    triangles: Vec<(u32, Triangle)>,
    boxes: Vec<BoxLanes>,
}

/// A leaf: where its triangles are, and the boxes around each eight of them.
#[derive(Clone, Debug)]
pub(super) struct Block {
    triangles: Range<usize>,
    boxes: Range<usize>,
}

impl Leaves {
    /// Forgets the leaves of the query before.
    pub(super) fn begin(&mut self, leaves: usize, origin: DVec3) {
        self.origin = origin;
        self.blocks.clear();
        self.triangles.clear();
        self.boxes.clear();
        self.query = self.query.wrapping_add(1);
        if self.query == 0 {
            self.stamps.fill((0, 0));
            self.query = 1;
        }
        if self.stamps.len() < leaves {
            self.stamps.resize(leaves, (0, 0));
        }
    }

    /// A leaf's block; its vertices are blended and placed at the first call.
    #[inline]
    pub(super) fn read(&mut self, tree: &mut impl Walkable, world_from_model: &WorldFromModel, leaf: Leaf) -> Block {
        let (query, block) = self.stamps[leaf.0];
        if query == self.query {
            return self.blocks[block as usize].clone();
        }
        self.stamps[leaf.0] = (self.query, self.blocks.len() as u32);
        let block = self.place(tree, world_from_model, leaf);
        self.blocks.push(block.clone());
        block
    }

    fn place(&mut self, tree: &mut impl Walkable, world_from_model: &WorldFromModel, leaf: Leaf) -> Block {
        self.numbers.clear();
        self.numbers.extend_from_slice(tree.topology().leaf_triangles(leaf));
        let (first, first_box) = (self.triangles.len(), self.boxes.len());
        for &number in &self.numbers {
            let triangle = world_triangle(tree, world_from_model, number);
            let lane = (self.triangles.len() - first) % LANES;
            if lane == 0 {
                self.boxes.push(BoxLanes::default());
            }
            if let Some(boxes) = self.boxes.last_mut() {
                boxes.set(lane, &rounded_box(&triangle, self.origin));
            }
            self.triangles.push((number, triangle));
        }
        Block {
            triangles: first..self.triangles.len(),
            boxes: first_box..self.boxes.len(),
        }
    }

    /// The numbers and corners of a leaf's triangles.
    pub(super) fn triangles(&self, block: &Block) -> &[(u32, Triangle)] {
        &self.triangles[block.triangles.clone()]
    }
}

/// Rounding is monotonic, so boxes that are apart after it were so before; of others nothing is known.
fn rounded_box([a, b, c]: &Triangle, origin: DVec3) -> Slab<3> {
    Slab {
        min: (a.min(*b).min(*c) - origin).as_vec3().to_array(),
        max: (a.max(*b).max(*c) - origin).as_vec3().to_array(),
    }
}

/// What testing the triangles of leaves took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LeafTests {
    pub(super) triangles: u64,
    pub(super) undecided_by_filter: u64,
}

/// Calls `visitor` for every pair of intersecting triangles of two leaves, until it breaks.
#[inline]
pub(super) fn intersecting_pairs(
    (leaves_a, a): (&Leaves, &Block),
    (leaves_b, b): (&Leaves, &Block),
    tests: &mut LeafTests,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let (of_a, of_b) = (leaves_a.triangles(a), leaves_b.triangles(b));
    for (i, (triangle_a, corners_a)) in of_a.iter().enumerate() {
        tests.triangles += of_b.len() as u64;
        let box_a = leaves_a.boxes[a.boxes.start + i / LANES].get(i % LANES);
        for (boxes_b, of_b) in leaves_b.boxes[b.boxes.clone()].iter().zip(of_b.chunks(LANES)) {
            let mut near = boxes_b.overlap_mask(&box_a) & (u8::MAX >> (LANES - of_b.len()));
            while near != 0 {
                let (triangle_b, corners_b) = &of_b[near.trailing_zeros() as usize];
                near &= near - 1;
                if triangles_intersect_counting(corners_a, corners_b, &mut tests.undecided_by_filter) {
                    visitor(TrianglePair {
                        triangle_a: *triangle_a,
                        triangle_b: *triangle_b,
                    })?;
                }
            }
        }
    }
    ControlFlow::Continue(())
}
