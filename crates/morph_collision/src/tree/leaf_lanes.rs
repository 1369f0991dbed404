//! The corners of leaves' triangles side by side, as they are blended for an exact test.

use glam::Vec3;

use super::Topology;
use crate::bounds::{LANES, Lanes};
use crate::model::MorphModel;

/// Three corners of up to eight triangles, by corner and coordinate.
pub(crate) type CornerLanes = [[Lanes; 3]; 3];

/// More targets than this in an average patch would take more memory than blending them side by side is worth.
const MOST_TARGETS: usize = 8;
/// And so would patches with fewer triangles than this on average.
const LEAST_TRIANGLES: usize = 4;

/// The triangles of every leaf in patches of eight: base corners, and displacements for each target that moves any of them.
#[derive(Clone, Debug)]
pub(crate) struct LeafLanes {
    /// The first patch of each leaf.
    firsts: Vec<u32>,
    bases: Vec<CornerLanes>,
    /// Targets of patch `i` and their displacements stand at `starts[i]..starts[i + 1]`, ascending.
    starts: Vec<u32>,
    targets: Vec<u32>,
    displacements: Vec<CornerLanes>,
}

/// A patch as it is blended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatchColumns<'a> {
    pub(crate) base: &'a CornerLanes,
    /// Ascending, as `displacements`.
    pub(crate) targets: &'a [u32],
    pub(crate) displacements: &'a [CornerLanes],
}

impl LeafLanes {
    /// `None` where too many targets move the average patch, or it has too few triangles; such a tree blends its vertices one
    /// by one.
    pub(super) fn new(model: &MorphModel, topology: &Topology) -> Option<Self> {
        let mut lanes = Self {
            firsts: Vec::new(),
            bases: Vec::new(),
            starts: vec![0],
            targets: Vec::new(),
            displacements: Vec::new(),
        };
        let lengths = topology.leaves().map(|leaf| topology.leaf_mesh(leaf).triangles.len());
        let patches: usize = lengths.map(|triangles| triangles.div_ceil(LANES)).sum();
        if model.triangle_count() < LEAST_TRIANGLES * patches {
            return None;
        }
        for leaf in topology.leaves() {
            lanes.firsts.push(lanes.bases.len() as u32);
            for triangles in topology.leaf_mesh(leaf).triangles.chunks(LANES) {
                lanes.push(model, triangles);
                if lanes.targets.len() > MOST_TARGETS * patches {
                    return None;
                }
            }
        }
        Some(lanes)
    }

    fn push(&mut self, model: &MorphModel, triangles: &[u32]) {
        let corners = || {
            in_lanes(triangles).flat_map(|(lane, triangle)| {
                let corners = model.triangle(triangle as usize);
                (0..).zip(corners).map(move |(corner, vertex)| (lane, corner, vertex))
            })
        };
        let mut base = CornerLanes::default();
        let mut targets = Vec::new();
        for (lane, corner, vertex) in corners() {
            put(&mut base, lane, corner, model.base(vertex));
            targets.extend(model.displacements(vertex).iter().map(|d| d.target));
        }
        targets.sort_unstable();
        targets.dedup();
        let first = self.displacements.len();
        self.displacements.resize(first + targets.len(), CornerLanes::default());
        for (lane, corner, vertex) in corners() {
            for displacement in model.displacements(vertex) {
                if let Ok(column) = targets.binary_search(&displacement.target) {
                    put(
                        &mut self.displacements[first + column],
                        lane,
                        corner,
                        displacement.delta,
                    );
                }
            }
        }
        self.bases.push(base);
        self.targets.extend(targets);
        self.starts.push(self.targets.len() as u32);
    }

    /// The patches of a leaf that has so many triangles.
    pub(crate) fn patches(&self, leaf: usize, triangles: usize) -> impl Iterator<Item = PatchColumns<'_>> {
        let first = self.firsts[leaf] as usize;
        (first..first + triangles.div_ceil(LANES)).map(|patch| {
            let columns = self.starts[patch] as usize..self.starts[patch + 1] as usize;
            PatchColumns {
                base: &self.bases[patch],
                targets: &self.targets[columns.clone()],
                displacements: &self.displacements[columns],
            }
        })
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.firsts)
            + size_of_val(&*self.bases)
            + size_of_val(&*self.starts)
            + size_of_val(&*self.targets)
            + size_of_val(&*self.displacements)
    }
}

/// Every lane with what is in it; lanes beyond the last item repeat it, so that what is true of all lanes is true of the
/// items.
pub(crate) fn in_lanes<T: Copy>(items: &[T]) -> impl Iterator<Item = (usize, T)> {
    let last = items.last().copied();
    let rest = std::iter::repeat_with(move || last).flatten();
    (0..LANES).zip(items.iter().copied().chain(rest))
}

/// Puts a corner's coordinates in a lane.
#[inline]
pub(crate) fn put(lanes: &mut CornerLanes, lane: usize, corner: usize, point: Vec3) {
    let rows = &mut lanes[corner % 3];
    rows[0].0[lane % LANES] = point.x;
    rows[1].0[lane % LANES] = point.y;
    rows[2].0[lane % LANES] = point.z;
}
