//! Leaves as patches of eight triangles: placed once per query, compared eight at a time, decided exactly where the filter cannot.

use std::cell::Cell;
use std::ops::{ControlFlow, Range};

use fearless_simd::Level;

use super::leaves::placed_triangle;
use super::neighbourhood::Neighbourhood;
use super::pairs::TrianglePair;
use super::patch::{Patch, PatchPairs};
use super::stats::QueryStats;
use crate::bounds::{LANES, WorldFromModel, lanes_of, with_simd};
use crate::exact::{Facet, Triangle, facets_intersect_counting};
use crate::pose::{EpochCache, Posed};
use crate::tree::{CornerLanes, Leaf};

/// The leaves of one body that a query has read, as patches of up to eight triangles. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct Patches {
    /// By leaf.
    blocks: EpochCache<Block>,
    neighbourhood: Neighbourhood,
    world_from_model: WorldFromModel,
    /// By patch: the corners in model space, and the patch in the neighbourhood of both bodies.
    posed: Vec<CornerLanes>,
    placed: Vec<Patch>,
    /// By patch and lane.
    numbers: Vec<[u32; LANES]>,
}

/// The patches of a leaf.
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
    /// Starts a query: forgets all leaves.
    pub(super) fn begin(&mut self, world_from_model: &WorldFromModel, neighbourhood: Neighbourhood) {
        self.blocks.next_epoch();
        self.world_from_model = *world_from_model;
        self.neighbourhood = neighbourhood;
        self.posed.clear();
        self.placed.clear();
        self.numbers.clear();
    }

    /// A leaf's block. Blends and places its corners on the first call.
    #[inline]
    pub(super) fn read(&mut self, tree: &mut Posed<'_>, leaf: Leaf) -> Block {
        match self.blocks.find(leaf.0) {
            Some(slot) => *self.blocks.get(slot),
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
        self.blocks.insert(leaf.0, block);
        block
    }

    /// A triangle's corners in world space.
    #[inline(always)]
    fn triangle(&self, patch: usize, lane: usize) -> Triangle {
        placed_triangle(&self.posed[patch], lane, &self.world_from_model)
    }
}

/// Calls `visitor` for every pair of intersecting triangles of two leaves until it breaks.
#[inline]
pub(super) fn intersecting_pairs(
    level: Level,
    (of_a, block_a): (&Patches, Block),
    (of_b, block_b): (&Patches, Block),
    stats: &mut QueryStats,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    stats.triangle_tests += u64::from(block_a.triangles) * u64::from(block_b.triangles);
    for a in block_a.patches() {
        for b in block_b.patches() {
            compare(level, (of_a, a), (of_b, b), |_, candidates| candidates, stats, visitor)?;
        }
    }
    ControlFlow::Continue(())
}

impl Patches {
    /// Calls `visitor` for every pair of intersecting triangles of two leaves of this body, or of a leaf and itself, until it
    /// breaks. Leaves out triangles that share a vertex.
    pub(super) fn intersecting_pairs_within(
        &self,
        posed: &Posed<'_>,
        [block_a, block_b]: [Block; 2],
        stats: &mut QueryStats,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let is_same_leaf = block_a.first == block_b.first;
        let tests = Cell::new(0);
        for a in block_a.patches() {
            for b in block_b.patches().filter(|&b| !is_same_leaf || b >= a) {
                let unrelated = |lane: usize, candidates: u8| {
                    let later = if a == b { (u8::MAX << 1) << lane } else { u8::MAX };
                    let unrelated = candidates & later & !self.neighbours(posed, (a, lane), b, candidates);
                    tests.set(tests.get() + u64::from(unrelated.count_ones()));
                    unrelated
                };
                let flow = compare(posed.level, (self, a), (self, b), unrelated, stats, visitor);
                stats.triangle_tests += tests.take();
                flow?;
            }
        }
        ControlFlow::Continue(())
    }

    /// The candidates in patch `b` that share a vertex with a triangle of patch `a`, as a bit mask.
    fn neighbours(&self, posed: &Posed<'_>, (a, lane): (usize, usize), b: usize, candidates: u8) -> u8 {
        let vertices = |number: u32| posed.model.corners(number);
        let [x, y, z] = vertices(self.numbers[a][lane]);
        lanes_of(candidates)
            .filter(|&other| {
                let others = vertices(self.numbers[b][other]);
                others.contains(&x) || others.contains(&y) || others.contains(&z)
            })
            .fold(0, |mask, other| mask | 1 << other)
    }
}

/// Calls `visitor` for the intersecting pairs of two patches, out of those that `select` leaves (see [`Patch::compare`]).
#[inline(always)]
fn compare(
    level: Level,
    (of_a, a): (&Patches, usize),
    (of_b, b): (&Patches, usize),
    select: impl Fn(usize, u8) -> u8,
    stats: &mut QueryStats,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut pairs = PatchPairs::default();
    let (patch_a, patch_b) = (&of_a.placed[a], &of_b.placed[b]);
    if with_simd!(level, simd => patch_a.compare(simd, patch_b, select, &mut pairs)) {
        report((of_a, a), (of_b, b), &pairs, stats, visitor)?;
    }
    ControlFlow::Continue(())
}

/// Passes the intersecting pairs to the visitor; decides exactly what the filter left open.
#[inline(never)]
fn report(
    (of_a, a): (&Patches, usize),
    (of_b, b): (&Patches, usize),
    pairs: &PatchPairs,
    stats: &mut QueryStats,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let (numbers_a, numbers_b) = (&of_a.numbers[a], &of_b.numbers[b]);
    for (lane_a, triangle_a) in numbers_a.iter().enumerate() {
        for lane_b in lanes_of(pairs.near[lane_a]) {
            let is_certain = pairs.meet[lane_a] >> lane_b & 1 == 1;
            if is_certain || decide(of_a.triangle(a, lane_a), of_b.triangle(b, lane_b), stats) {
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
fn decide(a: Triangle, b: Triangle, stats: &mut QueryStats) -> bool {
    facets_intersect_counting(&Facet::new(a), &Facet::new(b), &mut stats.undecided_by_filter)
}
