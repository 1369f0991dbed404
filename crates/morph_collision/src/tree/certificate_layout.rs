//! Certificates in a form that can be stored.

use std::sync::Arc;

use super::adjacency::{PatchPair, unrelated};
use super::certificates::SelfCertificates;
use super::layout_error::LayoutError;
use super::self_front::{Apart, SelfFront};
use super::topology::NodeId;
use super::{Leaf, MorphBvh, Topology};
use crate::bounds::{LANES, lanes_of};
use crate::hash::{START, hash};
use crate::model::WeightBox;

/// The part of a [`TreeLayout`](super::TreeLayout) that has the certificates of a tree.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub(super) struct CertificateLayout {
    low: Vec<f32>,
    high: Vec<f32>,
    /// Pairs of patches: two leaves, the index of a patch in each, and the mask of the pairs of triangles.
    neighbours: Vec<(u32, u32, u8, u8, u64)>,
    /// A child of a group, and children of another group as a mask.
    apart: Vec<(u32, u8, u32, u8)>,
    is_complete: bool,
    /// Of all numbers above. What is missing from the lists would be missing from answers.
    checksum: u64,
}

impl CertificateLayout {
    pub(super) fn new(certificates: &SelfCertificates) -> Self {
        let (weights, front) = (&certificates.weights, &certificates.front);
        let intervals = (0..weights.len()).filter_map(|target| weights.interval(target));
        let (low, high) = intervals.map(<(f32, f32)>::from).unzip();
        let neighbours = front.neighbours.iter().map(|pair| {
            let ([a, b], [i, j]) = (pair.leaves, pair.patches);
            (a, b, i, j, pair.unrelated)
        });
        let apart = front.apart.iter();
        let mut layout = Self {
            low,
            high,
            neighbours: neighbours.collect(),
            apart: apart
                .map(|step| (step.node.group, step.node.lane, step.group, step.mask))
                .collect(),
            is_complete: front.is_complete,
            checksum: 0,
        };
        layout.correct();
        layout
    }

    /// Certificates for the tree from whose layout they are.
    ///
    /// # Errors
    /// They are corrupt.
    pub(super) fn restore(&self, bvh: &MorphBvh) -> Result<SelfCertificates, LayoutError> {
        let corrupt = |what: &'static str| LayoutError::Certificates { what };
        if bvh.model().joint_count().is_some() {
            return Err(corrupt("the mesh has joints"));
        }
        if self.checksum != self.sum() {
            return Err(corrupt("the checksum is wrong"));
        }
        let weights =
            WeightBox::new(&self.low, &self.high).map_err(|_| corrupt("an interval of weights is invalid"))?;
        if weights.len() != bvh.model().target_count() {
            return Err(corrupt("the number of weights is wrong"));
        }
        let topology = &bvh.topology;
        let front = SelfFront {
            neighbours: self
                .neighbours
                .iter()
                .map(|&pair| patch_pair(bvh, pair))
                .collect::<Option<_>>()
                .ok_or(corrupt("a pair of leaves is invalid"))?,
            apart: self
                .apart
                .iter()
                .map(|&step| apart(topology, step))
                .collect::<Option<_>>()
                .ok_or(corrupt("a pair of nodes is invalid"))?,
            is_complete: self.is_complete,
        };
        if !self.is_without_repeats() {
            return Err(corrupt("an entry is there twice, or not in order"));
        }
        if !covers_once(topology, &front.apart) {
            return Err(corrupt("there are more pairs of leaves than in the tree"));
        }
        Ok(SelfCertificates {
            weights,
            topology: Arc::clone(topology),
            front,
        })
    }

    /// Whether neighbours ascend, as they are written, and nodes that are apart are different. Repeats would make queries slower, and their
    /// answers longer.
    fn is_without_repeats(&self) -> bool {
        let mut apart: Vec<_> = self
            .apart
            .iter()
            .map(|&(node, lane, group, _)| (node, lane, group))
            .collect();
        apart.sort_unstable();
        let neighbours = self.neighbours.windows(2);
        neighbours.into_iter().all(|pair| key(pair[0]) < key(pair[1])) && apart.windows(2).all(|pair| pair[0] < pair[1])
    }

    /// Gives changed certificates the right checksum, for tests and fuzzing.
    pub(super) fn correct(&mut self) {
        self.checksum = self.sum();
    }

    /// A hash of everything but the checksum.
    fn sum(&self) -> u64 {
        let weights = self
            .low
            .iter()
            .chain(&self.high)
            .map(|weight| u64::from(weight.to_bits()));
        let neighbours = self
            .neighbours
            .iter()
            .flat_map(|&(a, b, i, j, mask)| [a.into(), b.into(), i.into(), j.into(), mask >> 32, mask & 0xffff_ffff]);
        let apart = self
            .apart
            .iter()
            .flat_map(|&(a, i, b, mask)| [a.into(), i.into(), b.into(), u64::from(mask)]);
        let counts = [
            self.low.len(),
            self.neighbours.len(),
            self.apart.len(),
            self.is_complete.into(),
        ];
        let all = counts
            .map(|count| count as u64)
            .into_iter()
            .chain(weights)
            .chain(neighbours)
            .chain(apart);
        hash(START, all)
    }
}

/// The leaves, then the patches.
fn key((a, b, i, j, _): (u32, u32, u8, u8, u64)) -> (u32, u32, u8, u8) {
    (a, b, i, j)
}

/// Whether there are not more pairs of leaves below nodes that are apart than pairs of different leaves: no pair is below two of them.
fn covers_once(topology: &Topology, apart: &[Apart]) -> bool {
    let below = |child| {
        let [first, last] = topology.leaves_below(child);
        (last.0 - first.0 + 1) as u64
    };
    let covered = apart.iter().fold(0_u64, |sum, step| {
        let children = topology.group(step.group as usize).children();
        let others: u64 = lanes_of(step.mask)
            .filter_map(|lane| children.get(lane))
            .map(|&child| below(child))
            .sum();
        sum.saturating_add(below(step.node.child(topology)).saturating_mul(others))
    });
    let leaves = topology.leaf_count() as u64;
    covered <= leaves * leaves.saturating_sub(1) / 2
}

/// `None` if the tree has no such patches, or some of these triangles share a vertex.
fn patch_pair(bvh: &MorphBvh, (a, b, i, j, mask): (u32, u32, u8, u8, u64)) -> Option<PatchPair> {
    let patch = |leaf: u32, patch: u8| {
        let leaf = Leaf(leaf as usize);
        let triangles = (leaf.0 < bvh.topology.leaf_count()).then(|| bvh.topology.leaf_triangles(leaf));
        triangles?.chunks(LANES).nth(usize::from(patch))
    };
    let (of_a, of_b) = (patch(a, i)?, patch(b, j)?);
    let allowed = unrelated(bvh.model(), of_a, of_b, (a, i) == (b, j));
    (a <= b && mask & !allowed == 0).then_some(PatchPair {
        leaves: [a, b],
        patches: [i, j],
        unrelated: mask,
    })
}

/// `None` if the tree has no such nodes, or one is below the other.
fn apart(topology: &Topology, (node, lane, group, mask): (u32, u8, u32, u8)) -> Option<Apart> {
    let has = |group: u32| (group as usize) < topology.group_count();
    if !has(node) || !has(group) || mask & !topology.group(group as usize).mask() != 0 {
        return None;
    }
    let child = |group: u32, lane: usize| topology.group(group as usize).children().get(lane).copied();
    let [first, last] = topology.leaves_below(child(node, usize::from(lane))?);
    let are_apart = lanes_of(mask).all(|lane| {
        let below = child(group, lane).map(|other| topology.leaves_below(other));
        below.is_some_and(|[from, to]| to.0 < first.0 || last.0 < from.0)
    });
    let node = NodeId { group: node, lane };
    are_apart.then(|| Apart::new(node, group as usize, mask))?
}

#[cfg(test)]
mod tests {
    use morph_collision_models::generated::random::{random_blob, triangle_soup};

    use super::*;
    use crate::model::MorphModel;
    use crate::proof::{Effort, SelfProof};
    use crate::tree::BuildOptions;

    #[test]
    fn numbers_that_are_no_part_of_the_tree_are_errors_even_with_the_right_checksum() {
        let blob = random_blob(3, 3, 2, 0.9);
        let model = MorphModel::from_displacements(&blob.positions, &blob.triangles, &blob.targets).unwrap();
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
        let proof = SelfProof::new(&bvh, &WeightBox::unit(2), Effort::default()).unwrap();
        let layout = CertificateLayout::new(&proof.certificates(&proof.run()).unwrap());
        assert!(layout.restore(&bvh).is_ok());
        let breaks: [fn(&mut CertificateLayout); 17] = [
            |layout| layout.low[0] = f32::NAN,
            |layout| layout.high[1] = -1.0,
            |layout| layout.low.push(0.0),
            |layout| {
                layout.low.push(0.0);
                layout.high.push(0.0);
            },
            |layout| layout.neighbours[0].1 = u32::MAX,
            |layout| layout.neighbours[0].0 = layout.neighbours[0].1 + 1,
            |layout| layout.neighbours[0].2 = 255,
            |layout| layout.neighbours[0].3 = 9,
            |layout| layout.apart[0].0 = u32::MAX,
            |layout| layout.apart[0].1 = 8,
            |layout| layout.apart[0].2 = u32::MAX,
            |layout| layout.apart[0].3 = 0,
            // A node and itself, and a triangle and itself.
            |layout| (layout.apart[0].2, layout.apart[0].3) = (layout.apart[0].0, 1 << layout.apart[0].1),
            |layout| layout.neighbours[0] = (0, 0, 0, 0, 1),
            |layout| layout.neighbours.insert(1, layout.neighbours[0]),
            |layout| layout.neighbours.swap(0, 1),
            |layout| layout.apart.push(layout.apart[0]),
        ];
        for (index, damage) in breaks.iter().enumerate() {
            let mut broken = layout.clone();
            damage(&mut broken);
            assert!(broken.restore(&bvh).is_err(), "{index}");
            broken.correct();
            let error = broken.restore(&bvh).err().map(|error| error.to_string());
            let error = error.unwrap_or_else(|| panic!("{index} is accepted"));
            assert!(!error.contains("checksum"), "{error}");
            assert!(
                error.starts_with("tree layout: certificates: ") && error.ends_with("invalid")
                    || index < 4
                    || index > 13 && error.contains("twice"),
                "{index}: {error}"
            );
        }
    }
    /// Every pair of different leaves, each way round, although no entry is there twice.
    #[test]
    fn more_pairs_of_leaves_than_there_are_are_refused() {
        let soup = triangle_soup(3, 40, 0);
        let model = MorphModel::from_displacements(&soup.positions, &soup.triangles, &soup.targets).unwrap();
        let options = BuildOptions::default().with_leaf_size(1).unwrap();
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &options));
        let topology = &bvh.topology;
        let mut layout = CertificateLayout {
            low: Vec::new(),
            high: Vec::new(),
            neighbours: Vec::new(),
            apart: Vec::new(),
            is_complete: true,
            checksum: 0,
        };
        for node in 0..topology.group_count() as u32 {
            for lane in 0..LANES as u8 {
                for group in 0..topology.group_count() as u32 {
                    let masks = (0..LANES).map(|other| 1 << other);
                    let masks = masks.filter(|&mask| apart(topology, (node, lane, group, mask)).is_some());
                    let mask = masks.sum();
                    layout.apart.extend((mask != 0).then_some((node, lane, group, mask)));
                }
            }
        }
        layout.correct();
        let error = layout.restore(&bvh).err().map(|error| error.to_string());
        assert!(
            error
                .as_ref()
                .is_some_and(|error| error.contains("more pairs of leaves")),
            "{error:?}"
        );
        layout.apart.truncate(1);
        layout.correct();
        assert!(layout.restore(&bvh).is_ok());
    }
}
