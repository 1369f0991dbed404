//! The triangles of leaves in world space, kept for the time of a query: a leaf meets several of the other body's.

use std::ops::{ControlFlow, Range};

use fearless_simd::{Level, Simd};
use glam::DVec3;

use super::body::world_triangle;
use super::pairs::TrianglePair;
use crate::bounds::{BoxLanes, LANES, Slab, Volume, WorldFromModel, with_simd};
use crate::exact::{Facet, Triangle, facets_intersect_counting};
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
    triangles: Vec<(u32, Facet)>,
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
            self.triangles.push((number, Facet::new(triangle)));
        }
        Block {
            triangles: first..self.triangles.len(),
            boxes: first_box..self.boxes.len(),
        }
    }

    /// A leaf's triangles, with their numbers.
    pub(super) fn triangles(&self, block: &Block) -> &[(u32, Facet)] {
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

/// What testing the triangles of leaves takes, and took.
#[derive(Debug, Default)]
pub(super) struct LeafTests {
    /// Per triangle of the one leaf, which of each eight of the other have boxes that meet its own.
    near: Vec<u8>,
    pub(super) triangles: u64,
    pub(super) undecided_by_filter: u64,
}

impl LeafTests {
    /// Counts from 0 again; keeps the memory.
    pub(super) fn begin(&mut self) {
        self.triangles = 0;
        self.undecided_by_filter = 0;
    }
}

/// Calls `visitor` for every pair of intersecting triangles of two leaves, until it breaks.
#[inline]
pub(super) fn intersecting_pairs(
    level: Level,
    (leaves_a, a): (&Leaves, &Block),
    (leaves_b, b): (&Leaves, &Block),
    tests: &mut LeafTests,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let (of_a, of_b) = (leaves_a.triangles(a), leaves_b.triangles(b));
    let (boxes_a, boxes_b) = (&leaves_a.boxes[a.boxes.clone()], &leaves_b.boxes[b.boxes.clone()]);
    tests.triangles += (of_a.len() * of_b.len()) as u64;
    tests.near.clear();
    let any = with_simd!(level, simd => near_boxes(simd, boxes_a, of_a.len(), boxes_b, of_b.len(), &mut tests.near));
    if !any {
        return ControlFlow::Continue(());
    }
    let rows = tests.near.chunks_exact(boxes_b.len());
    for ((triangle_a, facet_a), row) in of_a.iter().zip(rows) {
        for (near, of_b) in row.iter().zip(of_b.chunks(LANES)) {
            let mut near = *near;
            while near != 0 {
                let (triangle_b, facet_b) = &of_b[near.trailing_zeros() as usize];
                near &= near - 1;
                if facets_intersect_counting(facet_a, facet_b, &mut tests.undecided_by_filter) {
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

/// Appends, for each of `count_a` boxes, a mask of the `count_b` others that it meets per eight of them; says if any does.
#[inline(always)]
fn near_boxes<S: Simd>(
    simd: S,
    boxes_a: &[BoxLanes],
    count_a: usize,
    boxes_b: &[BoxLanes],
    count_b: usize,
    near: &mut Vec<u8>,
) -> bool {
    let mut any = 0;
    for i in 0..count_a {
        let box_a = boxes_a[i / LANES].get(i % LANES);
        for (j, boxes) in boxes_b.iter().enumerate() {
            let lanes = u8::MAX >> (LANES - (count_b - j * LANES).min(LANES));
            let mask = boxes.overlap_mask(simd, &box_a) & lanes;
            any |= mask;
            near.push(mask);
        }
    }
    any != 0
}
