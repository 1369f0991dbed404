//! The corners of the leaves' triangles, eight triangles side by side, from which corners are blended for the exact tests.

use fearless_simd::f32x4;
use fearless_simd::prelude::*;
use glam::Vec3;

use super::budget::Budget;
use super::{Leaf, Topology};
use crate::bounds::{LANES, Lanes};
use crate::model::MorphModel;

/// The corners of up to eight triangles, by corner and coordinate.
pub(crate) type CornerLanes = [[Lanes; 3]; 3];

/// If patches have more targets than this on average, no lanes are stored. Not measured; it caps the displacements at 288 bytes
/// per triangle where patches are full.
const MAX_TARGETS: usize = 8;
/// If patches have fewer triangles than this on average, no lanes are stored. Not measured; more than half of the lanes would be
/// unused.
const MIN_TRIANGLES: usize = 4;

/// The triangles of every leaf in patches of eight: their base corners, and the displacements of each target that moves any of
/// them.
#[derive(Clone, Default)]
pub(crate) struct LeafLanes {
    /// One entry per patch.
    bases: Vec<CornerLanes>,
    /// `starts[i]..starts[i + 1]` are the entries of patch `i` in `targets` and `displacements`, ascending by target.
    starts: Vec<u32>,
    targets: Vec<u16>,
    displacements: Vec<CornerLanes>,
}

/// One patch.
#[derive(Clone, Copy)]
pub(crate) struct PatchColumns<'a> {
    pub(crate) base: &'a CornerLanes,
    /// Ascending.
    pub(crate) targets: &'a [u16],
    /// One entry per target.
    pub(crate) displacements: &'a [CornerLanes],
}

impl LeafLanes {
    /// `None` if the average patch has too many targets or too few triangles. Vertices are then blended one by one.
    pub(super) async fn new(model: &MorphModel, topology: &Topology, budget: &Budget) -> Option<Self> {
        let patches = topology.patch_count();
        if model.triangle_count() < MIN_TRIANGLES * patches {
            return None;
        }
        let work = |triangles: &[u32]| 3 * triangles.len() * (1 + model.target_count());
        let leaves = || (0..topology.leaf_count()).map(|leaf| topology.leaf_triangles(Leaf(leaf)));
        // Counted before anything is stored, because often nothing is.
        let (mut targets, mut last) = (0, vec![None; model.target_count()]);
        for (leaf, triangles) in leaves().enumerate() {
            budget.spend(work(triangles)).await;
            for (patch, triangles) in triangles.chunks(LANES).enumerate() {
                targets += count_targets(model, triangles, (leaf, patch), &mut last);
            }
            if targets > MAX_TARGETS * patches {
                return None;
            }
        }
        let mut lanes = Self {
            bases: Vec::with_capacity(patches),
            starts: Vec::with_capacity(patches + 1),
            targets: Vec::with_capacity(targets),
            displacements: Vec::with_capacity(targets),
        };
        lanes.starts.push(0);
        for triangles in leaves() {
            budget.spend(work(triangles)).await;
            for triangles in triangles.chunks(LANES) {
                lanes.push(model, triangles);
            }
        }
        Some(lanes)
    }

    /// Adds the next patch.
    fn push(&mut self, model: &MorphModel, triangles: &[u32]) {
        let mut base = CornerLanes::default();
        let mut targets = Vec::new();
        for (lane, triangle) in in_lanes(triangles) {
            for (corner, vertex) in model.corners(triangle).into_iter().enumerate() {
                put(&mut base, lane, corner, model.base(vertex));
                targets.extend(model.displacements(vertex).map(|d| d.target));
            }
        }
        targets.sort_unstable();
        targets.dedup();
        let mut displacements = vec![CornerLanes::default(); targets.len()];
        for (lane, triangle) in in_lanes(triangles) {
            for (corner, vertex) in model.corners(triangle).into_iter().enumerate() {
                for displacement in model.displacements(vertex) {
                    let column = targets.partition_point(|&target| target < displacement.target);
                    put(&mut displacements[column], lane, corner, displacement.delta);
                }
            }
        }
        self.bases.push(base);
        self.targets.extend(targets);
        self.displacements.extend(displacements);
        self.starts.push(self.targets.len() as u32);
    }

    #[inline(always)]
    pub(crate) fn patch(&self, patch: usize) -> PatchColumns<'_> {
        let columns = self.starts[patch] as usize..self.starts[patch + 1] as usize;
        PatchColumns {
            base: &self.bases[patch],
            targets: &self.targets[columns.clone()],
            displacements: &self.displacements[columns],
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.bases)
            + size_of_val(&*self.starts)
            + size_of_val(&*self.targets)
            + size_of_val(&*self.displacements)
    }
}

/// The number of targets that move any of some triangles. `last` is the patch that each target was last counted for.
fn count_targets(
    model: &MorphModel,
    triangles: &[u32],
    patch: (usize, usize),
    last: &mut [Option<(usize, usize)>],
) -> usize {
    let mut count = 0;
    for vertex in triangles.iter().flat_map(|&triangle| model.corners(triangle)) {
        for displacement in model.displacements(vertex) {
            let last = &mut last[usize::from(displacement.target)];
            count += usize::from(last.replace(patch) != Some(patch));
        }
    }
    count
}

/// Sets the lanes to the corners of at most eight triangles, which index `points`. Only the first three numbers of a point are used.
/// Lanes beyond the last triangle repeat it, so a condition on all lanes is a condition on all triangles.
#[inline(always)]
pub(crate) fn gather<S: Simd>(simd: S, triangles: &[[u16; 3]], points: &[[f32; 4]], lanes: &mut CornerLanes) {
    gather_by(simd, triangles, |corner| &points[usize::from(corner)], lanes);
}

/// Likewise for triangles that index `vertices`, which index `points`.
#[inline(always)]
pub(crate) fn gather_from<S: Simd>(
    simd: S,
    triangles: &[[u16; 3]],
    vertices: &[u32],
    points: &[[f32; 4]],
    lanes: &mut CornerLanes,
) {
    gather_by(
        simd,
        triangles,
        |corner| &points[vertices[usize::from(corner)] as usize],
        lanes,
    );
}

#[inline(always)]
fn gather_by<'p, S: Simd>(
    simd: S,
    triangles: &[[u16; 3]],
    point: impl Fn(u16) -> &'p [f32; 4],
    lanes: &mut CornerLanes,
) {
    let Some(last) = triangles.len().checked_sub(1) else {
        return;
    };
    for first in [0, LANES / 2] {
        let [p, q, r, s] = [0, 1, 2, 3].map(|i| &triangles[(first + i).min(last)]);
        for (corner, rows) in lanes.iter_mut().enumerate() {
            let a = f32x4::from_slice(simd, point(p[corner]));
            let b = f32x4::from_slice(simd, point(q[corner]));
            let c = f32x4::from_slice(simd, point(r[corner]));
            let d = f32x4::from_slice(simd, point(s[corner]));
            let (ac, bd) = (a.zip_low(c), b.zip_low(d));
            let (ac_high, bd_high) = (a.zip_high(c), b.zip_high(d));
            ac.zip_low(bd).store_slice(&mut rows[0].0[first..first + 4]);
            ac.zip_high(bd).store_slice(&mut rows[1].0[first..first + 4]);
            ac_high.zip_low(bd_high).store_slice(&mut rows[2].0[first..first + 4]);
        }
    }
}

/// Pairs every lane with an item. Lanes beyond the last item repeat it, so a condition on all lanes is a condition on all items.
pub(crate) fn in_lanes<T: Copy>(items: &[T]) -> impl Iterator<Item = (usize, T)> {
    let rest = items.last().copied().into_iter().cycle();
    (0..LANES).zip(items.iter().copied().chain(rest))
}

/// Stores a corner in a lane.
#[inline]
pub(crate) fn put(lanes: &mut CornerLanes, lane: usize, corner: usize, point: Vec3) {
    let rows = &mut lanes[corner % 3];
    rows[0].0[lane % LANES] = point.x;
    rows[1].0[lane % LANES] = point.y;
    rows[2].0[lane % LANES] = point.z;
}
