//! The leaves of two bodies against each other: what the filter of their patches leaves over is decided exactly.

use std::ops::{ControlFlow, Range};

use super::leaves::{LeafStamps, placed_triangle};
use super::neighbourhood::Neighbourhood;
use super::pairs::TrianglePair;
use super::patch::{Patch, PatchPairs};
use crate::bounds::{LANES, WorldFromModel, with_simd};
use crate::exact::{Facet, Triangle, facets_intersect_counting};
use crate::pose::Posed;
use crate::tree::{CornerLanes, Leaf};
use fearless_simd::Level;

/// The leaves of one body that a query has read, as patches of up to eight triangles; the memory is reused by the next query.
#[derive(Debug, Default)]
pub(super) struct Patches {
    stamps: LeafStamps,
    blocks: Vec<Block>,
    neighbourhood: Neighbourhood,
    world_from_model: WorldFromModel,
    /// In model space, and the same near both bodies; both by patch.
    posed: Vec<CornerLanes>,
    placed: Vec<Patch>,
    /// By patch and lane.
    numbers: Vec<[u32; LANES]>,
}

/// A leaf that was read: its patches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    first: u32,
    triangles: u32,
}

impl Block {
    fn patches(&self) -> Range<usize> {
        let first = self.first as usize;
        first..first + (self.triangles as usize).div_ceil(LANES)
    }
}

impl Patches {
    /// Forgets the leaves of the query before.
    pub(super) fn begin(&mut self, leaves: usize, world_from_model: &WorldFromModel, neighbourhood: Neighbourhood) {
        self.stamps.begin(leaves);
        self.world_from_model = *world_from_model;
        self.neighbourhood = neighbourhood;
        self.blocks.clear();
        self.posed.clear();
        self.placed.clear();
        self.numbers.clear();
    }

    /// A leaf's block; its corners are blended and placed at the first call.
    #[inline]
    pub(super) fn read(&mut self, tree: &mut Posed<'_>, leaf: Leaf) -> Block {
        match self.stamps.find(leaf) {
            Some(block) => self.blocks[block],
            None => self.place(tree, leaf),
        }
    }

    #[inline(never)]
    fn place(&mut self, tree: &mut Posed<'_>, leaf: Leaf) -> Block {
        let first = self.posed.len();
        tree.leaf_corners(leaf, &mut self.posed);
        let level = tree.level;
        let triangles = tree.topology.leaf_mesh(leaf).triangles;
        for (posed, numbers) in self.posed[first..].iter().zip(triangles.chunks(LANES)) {
            self.placed.push(Patch::default());
            if let Some(patch) = self.placed.last_mut() {
                with_simd!(level, simd => patch.place(simd, posed, numbers.len(), &self.world_from_model, &self.neighbourhood));
            }
            let mut room = [0; LANES];
            room[..numbers.len()].copy_from_slice(numbers);
            self.numbers.push(room);
        }
        let block = Block {
            first: first as u32,
            triangles: triangles.len() as u32,
        };
        self.stamps.insert(leaf, self.blocks.len());
        self.blocks.push(block);
        block
    }

    /// The corners of a triangle in world space.
    #[inline(always)]
    fn triangle(&self, patch: usize, lane: usize) -> Triangle {
        placed_triangle(&self.posed[patch], lane, &self.world_from_model)
    }
}

/// What testing the triangles of leaves took.
#[derive(Debug, Default)]
pub(super) struct LeafTests {
    pub(super) triangles: u64,
    pub(super) undecided_by_filter: u64,
}

/// Calls `visitor` for every pair of intersecting triangles of two leaves, until it breaks.
#[inline]
pub(super) fn intersecting_pairs(
    level: Level,
    (of_a, block_a): (&Patches, Block),
    (of_b, block_b): (&Patches, Block),
    tests: &mut LeafTests,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    tests.triangles += u64::from(block_a.triangles) * u64::from(block_b.triangles);
    for a in block_a.patches() {
        for b in block_b.patches() {
            let (patch_a, patch_b) = (&of_a.placed[a], &of_b.placed[b]);
            let mut pairs = PatchPairs::default();
            if with_simd!(level, simd => patch_a.compare(simd, patch_b, &mut pairs)) {
                report((of_a, a), (of_b, b), &pairs, tests, visitor)?;
            }
        }
    }
    ControlFlow::Continue(())
}

/// Gives the pairs that meet to the visitor; what the filter leaves open is decided exactly.
#[inline(never)]
fn report(
    (of_a, a): (&Patches, usize),
    (of_b, b): (&Patches, usize),
    pairs: &PatchPairs,
    tests: &mut LeafTests,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let (numbers_a, numbers_b) = (&of_a.numbers[a], &of_b.numbers[b]);
    for (lane_a, triangle_a) in numbers_a.iter().enumerate() {
        let mut near = pairs.near[lane_a];
        while near != 0 {
            let lane_b = near.trailing_zeros() as usize;
            near &= near - 1;
            let certain = pairs.meet[lane_a] >> lane_b & 1 == 1;
            if certain || decide(of_a.triangle(a, lane_a), of_b.triangle(b, lane_b), tests) {
                visitor(TrianglePair {
                    triangle_a: *triangle_a,
                    triangle_b: numbers_b[lane_b],
                })?;
            }
        }
    }
    ControlFlow::Continue(())
}

#[inline(never)]
fn decide(a: Triangle, b: Triangle, tests: &mut LeafTests) -> bool {
    facets_intersect_counting(&Facet::new(a), &Facet::new(b), &mut tests.undecided_by_filter)
}
