//! Leaves as patches of eight triangles: placed once per query, compared eight at a time, decided exactly if the filter cannot
//! decide.

use std::cell::Cell;
use std::ops::{ControlFlow, Range};

use fearless_simd::Simd;

use super::patch::{Patch, Row};
use crate::bounds::{LANES, WorldFromModel, lanes_of, with_simd};
use crate::exact::{Facet, Triangle, facets_intersect_counting};
use crate::pose::{EpochCache, Posed};
use crate::query::stats::QueryStats;
use crate::query::triangle_pair::TrianglePair;
use crate::query::two_bodies::{Neighbourhood, Placement};
use crate::tree::{Leaf, PatchPair, Topology, gather, unrelated};

/// The patches of one body that a query has used. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct Patches {
    /// Indexed by patch.
    placed: EpochCache<Patch>,
    placement: Placement,
    /// Scratch memory: the vertices of a skinned mesh's leaf, relative to the neighbourhood. The fourth number is padding.
    points: Vec<[f32; 4]>,
}

/// One body of a query.
pub(super) struct Side<'q, 'p> {
    tree: &'q mut Posed<'p>,
    patches: &'q mut Patches,
}

impl Patches {
    /// Starts a query: clears all patches.
    pub(super) fn begin(&mut self, neighbourhood: &Neighbourhood, world_from_model: &WorldFromModel) {
        self.placed.next_epoch();
        self.placement = neighbourhood.placement(world_from_model);
    }
}

impl<'q, 'p> Side<'q, 'p> {
    pub(super) fn new(tree: &'q mut Posed<'p>, patches: &'q mut Patches) -> Self {
        Self { tree, patches }
    }

    /// The slots of a leaf's patches. Blends and places their corners on the first call.
    #[inline(always)]
    fn read(&mut self, leaf: Leaf) -> Range<usize> {
        let patches = self.tree.topology.patches(leaf);
        let first = match self.patches.placed.find(patches.start) {
            Some(slot) => slot,
            None => self.place(leaf, patches.clone()),
        };
        first..first + patches.len()
    }

    #[inline(never)]
    fn place(&mut self, leaf: Leaf, patches: Range<usize>) -> usize {
        with_simd!(self.tree.level, simd => self.place_patches(simd, leaf, patches))
    }

    #[inline(always)]
    fn place_patches<S: Simd>(&mut self, simd: S, leaf: Leaf, patches: Range<usize>) -> usize {
        let Patches {
            placed,
            placement,
            points,
        } = &mut *self.patches;
        let triangles = self.tree.topology.leaf_range(leaf);
        let mut slot = 0;
        for (index, patch) in patches.enumerate() {
            slot = placed.claim(patch);
            let patch = placed.get_mut(slot);
            let first = triangles.start + index * LANES;
            patch.first = first as u32;
            if self.tree.is_skinned() {
                let mesh = self.tree.topology.leaf_mesh(leaf);
                let triangles = mesh.corners.chunks(LANES).nth(index).unwrap_or_default();
                placement.place_points(simd, self.tree.leaf_positions(leaf), points);
                gather(simd, triangles, points, &mut patch.corners);
            } else {
                self.tree.patch_corners(simd, leaf, index, &mut patch.corners);
                placement.place(simd, &mut patch.corners);
            }
            patch.measure(simd, triangles.end - first);
        }
        slot + 1 - triangles.len().div_ceil(LANES).max(1)
    }
}

/// Calls `visitor` for every pair of intersecting triangles in the given pairs of leaves, until it breaks.
pub(super) fn intersecting_pairs(
    a: &mut Side<'_, '_>,
    b: &mut Side<'_, '_>,
    leaves: &[(Leaf, Leaf)],
    stats: &mut QueryStats,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    with_simd!(a.tree.level, simd => intersecting(simd, a, b, leaves, stats, visitor))
}

#[inline(always)]
fn intersecting<S: Simd>(
    simd: S,
    a: &mut Side<'_, '_>,
    b: &mut Side<'_, '_>,
    leaves: &[(Leaf, Leaf)],
    stats: &mut QueryStats,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let topologies = [a.tree.topology, b.tree.topology];
    for &(leaf_a, leaf_b) in leaves {
        let (slots_a, slots_b) = (a.read(leaf_a), b.read(leaf_b));
        for slot_a in slots_a {
            for slot_b in slots_b.clone() {
                let (patch_a, patch_b) = (a.patches.placed.get(slot_a), b.patches.placed.get(slot_b));
                stats.triangle_tests += u64::from(patch_a.triangles) * u64::from(patch_b.triangles);
                let masks = patch_a.overlaps(simd, patch_b);
                if masks == [0; 2] {
                    continue;
                }
                // Use the side with fewer rows, so that each has more triangles.
                let is_swapped = masks[1].count_ones() < masks[0].count_ones();
                let (patches, masks) = if is_swapped {
                    ([patch_b, patch_a], [masks[1], masks[0]])
                } else {
                    ([patch_a, patch_b], masks)
                };
                let in_order = |[x, y]: [u32; 2]| if is_swapped { [y, x] } else { [x, y] };
                let found = |row: Row| {
                    let [topology_a, topology_b] = topologies;
                    let topologies = if is_swapped {
                        [topology_b, topology_a]
                    } else {
                        topologies
                    };
                    let exactly = |numbers: [u32; 2], stats: &mut QueryStats| {
                        let [number_a, number_b] = in_order(numbers);
                        let corners_a = a.tree.world_triangle(number_a);
                        let corners_b = b.tree.world_triangle(number_b);
                        decide(corners_a, corners_b, stats)
                    };
                    let at_pair = |numbers: [u32; 2]| {
                        let [triangle_a, triangle_b] = in_order(numbers);
                        visitor(TrianglePair { triangle_a, triangle_b })
                    };
                    report(topologies, patches, row, exactly, stats, at_pair)
                };
                patches[0].compare(simd, patches[1], masks, |_, near| near, found)?;
            }
        }
    }
    ControlFlow::Continue(())
}

/// Calls `visitor` for every pair of intersecting triangles in the given pairs of patches of one body that share no vertex, until it
/// breaks.
pub(super) fn intersecting_neighbours(
    body: &mut Side<'_, '_>,
    neighbours: &[PatchPair],
    stats: &mut QueryStats,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    with_simd!(body.tree.level, simd => {
        for pair in neighbours.iter().filter(|pair| pair.unrelated != 0) {
            let [leaf_a, leaf_b] = pair.leaves();
            let slots = [
                body.read(leaf_a).start + usize::from(pair.patches[0]),
                body.read(leaf_b).start + usize::from(pair.patches[1]),
            ];
            intersecting_within(simd, body, slots, pair.unrelated, stats, visitor)?;
        }
        ControlFlow::Continue(())
    })
}

/// Calls `visitor` for every pair of intersecting triangles in two different leaves of one body that share no vertex, until it breaks.
/// `may_share` says whether any two triangles of the leaves might share a vertex.
pub(super) fn intersecting_pairs_within(
    body: &mut Side<'_, '_>,
    leaves: [Leaf; 2],
    may_share: bool,
    stats: &mut QueryStats,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let [slots_a, slots_b] = leaves.map(|leaf| body.read(leaf));
    let (model, topology) = (body.tree.model, body.tree.topology);
    let triangles = |leaf, slots: &Range<usize>, slot: usize| {
        let triangles: &[u32] = topology.leaf_triangles(leaf);
        triangles.chunks(LANES).nth(slot - slots.start).unwrap_or_default()
    };
    with_simd!(body.tree.level, simd => {
        for slot_a in slots_a.clone() {
            for slot_b in slots_b.clone() {
                let mut mask = u64::MAX;
                if may_share {
                    let [a, b] = [triangles(leaves[0], &slots_a, slot_a), triangles(leaves[1], &slots_b, slot_b)];
                    mask = unrelated(model, a, b, false);
                }
                intersecting_within(simd, body, [slot_a, slot_b], mask, stats, visitor)?;
            }
        }
        ControlFlow::Continue(())
    })
}

/// Compares two patches of one body. `mask` has the pairs of triangles to test, as [`PatchPair::unrelated`].
#[inline(always)]
fn intersecting_within<S: Simd>(
    simd: S,
    body: &mut Side<'_, '_>,
    slots: [usize; 2],
    mask: u64,
    stats: &mut QueryStats,
    visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let topologies = [body.tree.topology; 2];
    let patches = slots.map(|slot| body.patches.placed.get(slot));
    let [own, others] = patches[0].overlaps(simd, patches[1]);
    let tests = Cell::new(0);
    let select = |lane: usize, candidates: u8| {
        let tested = candidates & PatchPair::unrelated_to(mask, lane);
        tests.set(tests.get() + tested.count_ones());
        tested
    };
    let found = |row| {
        let exactly = |[number_a, number_b]: [u32; 2], stats: &mut QueryStats| {
            let mut corners = |number| body.tree.world_triangle(number);
            let [corners_a, corners_b] = [number_a, number_b].map(&mut corners);
            decide(corners_a, corners_b, stats)
        };
        let at_pair = |[triangle_a, triangle_b]: [u32; 2]| visitor(TrianglePair { triangle_a, triangle_b });
        report(topologies, patches, row, exactly, stats, at_pair)
    };
    let rows = [own & PatchPair::rows(mask), others];
    let flow = patches[0].compare(simd, patches[1], rows, select, found);
    stats.triangle_tests += u64::from(tests.get());
    flow
}

/// The index of the triangle in a patch's lane.
#[inline(always)]
fn number(topology: &Topology, patch: &Patch, lane: usize) -> u32 {
    topology.triangle(patch.first as usize + lane)
}

/// Passes the intersecting pairs of a row to `at_pair`. `exactly` decides the pairs that the filter could not.
#[inline(always)]
fn report(
    [topology_a, topology_b]: [&Topology; 2],
    [a, b]: [&Patch; 2],
    row: Row,
    mut exactly: impl FnMut([u32; 2], &mut QueryStats) -> bool,
    stats: &mut QueryStats,
    mut at_pair: impl FnMut([u32; 2]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let triangle_a = number(topology_a, a, row.lane);
    for lane in lanes_of(row.near) {
        let numbers = [triangle_a, number(topology_b, b, lane)];
        if row.meet >> lane & 1 == 1 || exactly(numbers, stats) {
            at_pair(numbers)?;
        }
    }
    ControlFlow::Continue(())
}

#[inline(never)]
fn decide(a: Triangle, b: Triangle, stats: &mut QueryStats) -> bool {
    facets_intersect_counting(&Facet::new(a), &Facet::new(b), &mut stats.undecided_by_filter)
}
