//! What is left of a walk over a tree and itself, if most pairs of triangles are proved free.

use std::fmt;
use std::sync::Arc;

use super::adjacency::PatchPair;
use super::self_front::{Apart, SelfFront};
use super::topology::{Child, Topology};

use crate::bounds::lanes_of;
use crate::model::WeightBox;

/// Which pairs of a mesh's triangles are proved never to touch for any weights in a box.
///
/// While the weights are in the box, a [`SelfQuery`](crate::SelfQuery) leaves these pairs out. It finds the same pairs in the same order, but
/// most leaves of the tree are not even blended. With any weight outside the box, also one that overshoots by a rounding, it works as without
/// certificates, so choose a box with a margin if weights may overshoot.
///
/// Made by [`SelfProof::certificates`](crate::proof::SelfProof::certificates), given to a tree by [`MorphBvh::set_certificates`](crate::MorphBvh::set_certificates), and stored
/// with its [`TreeLayout`](crate::TreeLayout).
#[derive(Clone)]
pub struct SelfCertificates {
    pub(super) weights: WeightBox,
    pub(super) topology: Arc<Topology>,
    pub(super) front: SelfFront,
}

/// Pairs of triangles that are not proved free.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct OpenPairs {
    /// Patches with pairs that are open, as a mask.
    pub(crate) patches: Vec<PatchPair>,
    /// Ranges of leaves between which everything is open, and the same twice for a range and itself. The first one comes first.
    pub(crate) areas: Vec<Area>,
}

/// The first and the last of a range of leaves.
type Leaves = [u32; 2];

/// All pairs of a leaf of the first range and one of the second.
pub(crate) type Area = [Leaves; 2];

impl SelfCertificates {
    /// `open` has all pairs of triangles that share no vertex and are not proved free.
    pub(super) fn new(topology: &Arc<Topology>, whole: &SelfFront, weights: WeightBox, open: &OpenPairs) -> Self {
        Self {
            weights,
            topology: Arc::clone(topology),
            front: open_front(topology, whole, open),
        }
    }

    /// The weights for which they hold.
    #[must_use]
    pub fn weights(&self) -> &WeightBox {
        &self.weights
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.front.bytes() + 2 * size_of::<f32>() * self.weights.len()
    }
}

impl fmt::Debug for SelfCertificates {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SelfCertificates")
            .field("targets", &self.weights.len())
            .field("starts", &self.front.apart.len())
            .field("neighbours", &self.front.neighbours.len())
            .finish_non_exhaustive()
    }
}

/// What is open of a tree's front.
fn open_front(topology: &Topology, whole: &SelfFront, open: &OpenPairs) -> SelfFront {
    let index = OpenIndex::new(open);
    let open_neighbours = |pair: &PatchPair| {
        let unrelated = pair.unrelated & index.mask(pair);
        (unrelated != 0).then_some(PatchPair { unrelated, ..*pair })
    };
    let open_step = |step: &Apart| {
        let node = leaves_below(topology, step.node.child(topology));
        let others = topology.group(step.group as usize).children();
        let is_open = |lane: &usize| index.has_any(node, leaves_below(topology, others[*lane]));
        let lanes = lanes_of(step.mask).filter(is_open);
        Apart::new(
            step.node,
            step.group as usize,
            lanes.fold(0, |mask, lane| mask | 1 << lane),
        )
    };
    SelfFront {
        neighbours: whole.neighbours.iter().filter_map(open_neighbours).collect(),
        apart: whole.apart.iter().filter_map(open_step).collect(),
        is_complete: whole.is_complete,
    }
}

fn leaves_below(topology: &Topology, node: Child) -> Leaves {
    topology.leaves_below(node).map(|leaf| leaf.0 as u32)
}

/// Open pairs, found by their leaves.
struct OpenIndex<'a> {
    /// Ascending by leaves and patches.
    patches: Vec<&'a PatchPair>,
    areas: &'a [Area],
}

impl<'a> OpenIndex<'a> {
    fn new(open: &'a OpenPairs) -> Self {
        let mut patches: Vec<&PatchPair> = open.patches.iter().collect();
        patches.sort_unstable_by_key(|pair| (pair.leaves, pair.patches));
        Self {
            patches,
            areas: &open.areas,
        }
    }

    /// Which pairs of triangles of two patches are open.
    fn mask(&self, pair: &PatchPair) -> u64 {
        let [a, b] = pair.leaves;
        if self.areas.iter().any(|[x, y]| contains(*x, a) && contains(*y, b)) {
            return u64::MAX;
        }
        let key = |pair: &PatchPair| (pair.leaves, pair.patches);
        let found = self.patches.binary_search_by_key(&key(pair), |pair| key(pair));
        found.map_or(0, |i| self.patches[i].unrelated)
    }

    /// Whether anything between two ranges of leaves is open. They have no leaf in common.
    fn has_any(&self, a: Leaves, b: Leaves) -> bool {
        let ([first, last], second) = if a < b { (a, b) } else { (b, a) };
        let meet = |a: Leaves, b: Leaves| a[0] <= b[1] && b[0] <= a[1];
        if self
            .areas
            .iter()
            .any(|[x, y]| meet(*x, [first, last]) && meet(*y, second))
        {
            return true;
        }
        // For each first leaf, look for the first of its pairs whose second leaf is not before the range.
        let mut rest = &self.patches[..];
        let mut leaf = first;
        loop {
            rest = &rest[rest.partition_point(|pair| pair.leaves < [leaf, second[0]])..];
            match rest.first() {
                Some(pair) if pair.leaves[0] > last => return false,
                Some(pair) if contains(second, pair.leaves[1]) => return true,
                // Its own second leaves are all before or behind the range.
                Some(pair) => leaf = pair.leaves[0] + u32::from(pair.leaves[0] == leaf),
                None => return false,
            }
        }
    }
}

fn contains([first, last]: Leaves, leaf: u32) -> bool {
    first <= leaf && leaf <= last
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    #[test]
    fn the_index_finds_what_is_open() {
        let mut rng = Pcg64Mcg::seed_from_u64(30);
        let mut seen = [0; 2];
        for round in 0..200 {
            let leaves = 40;
            let patch_pair = |rng: &mut Pcg64Mcg| {
                let [a, b] = [(); 2].map(|()| rng.random_range(0..leaves));
                PatchPair {
                    leaves: [a.min(b), a.max(b)],
                    patches: [0, rng.random_range(0..2)],
                    unrelated: rng.random_range(1..=u64::MAX),
                }
            };
            let mut open = OpenPairs {
                patches: (0..round % 30).map(|_| patch_pair(&mut rng)).collect(),
                areas: Vec::new(),
            };
            open.patches.sort_unstable_by_key(|pair| (pair.leaves, pair.patches));
            open.patches.dedup_by_key(|pair| (pair.leaves, pair.patches));
            if round % 4 == 0 {
                open.areas.push([[3, 5], [30, 33]]);
            }
            let index = OpenIndex::new(&open);
            let range = |rng: &mut Pcg64Mcg, from: u32, to: u32| {
                let first = rng.random_range(from..to);
                [first, rng.random_range(first..to)]
            };
            for _ in 0..100 {
                let cut = rng.random_range(1..leaves);
                let (a, b) = (range(&mut rng, 0, cut), range(&mut rng, cut, leaves));
                let is_in = |x: u32, y: u32| contains(a, x) && contains(b, y);
                let of_patches = open.patches.iter().any(|pair| is_in(pair.leaves[0], pair.leaves[1]));
                let of_areas = !open.areas.is_empty() && (3..=5).any(|x| (30..=33).any(|y| is_in(x, y)));
                let expected = of_patches || of_areas;
                assert_eq!(
                    [index.has_any(a, b), index.has_any(b, a)],
                    [expected; 2],
                    "{a:?} {b:?} {open:?}"
                );
                seen[usize::from(expected)] += 1;
            }
            for pair in &open.patches {
                assert!(index.mask(pair) == pair.unrelated || index.mask(pair) == u64::MAX);
            }
        }
        assert!(seen[0] > 1000 && seen[1] > 1000, "{seen:?}");
    }
}
