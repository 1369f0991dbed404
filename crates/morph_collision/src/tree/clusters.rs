//! Splits the vertices of a node by the joints that move them most, and collects the bounds of each part.

use std::collections::BTreeMap;

use super::extents::NodeExtents;
use crate::model::{Influence, MorphModel, Skin, sum_rounding};

/// Second joints with less weight than this do not split clusters (docs/skinning.md).
const MIN_SECOND: f32 = 0.05;
/// If the sum of a vertex's weights differs from 1 by more than this, the difference counts as an influence.
const MISSING: f64 = 1.0 / (1 << 20) as f64;

/// The smallest and the largest weight of a joint over the vertices of a cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) joint: u16,
    pub(super) low: f32,
    pub(super) high: f32,
}

/// Vertices with the same strongest and second joint. All vertices of a mesh without joints are one cluster.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    /// The strongest joint, and the second one, or [`NONE`].
    key: [u16; 2],
    /// The extents of the vertices before joints move them.
    pub(super) extents: NodeExtents,
    /// Ascending by joint. Joints that are not listed have weight 0. If weights do not sum to 1, an extra joint after the last one, whose
    /// matrix is 0, gets the difference.
    pub(super) weights: Vec<Interval>,
    /// The largest `|1 - sum of weights|` over vertices for which that difference is not in `weights`.
    pub(super) missing: f32,
    /// Roughly the sum of each joint's weights over the vertices. It tells which joint moves most of a node.
    pub(super) shares: Vec<(u16, f32)>,
}

/// Stands for no joint.
pub(super) const NONE: u16 = u16::MAX;

impl Cluster {
    /// The only cluster of a node of a mesh without joints.
    pub(super) fn without_joints(extents: NodeExtents) -> Self {
        Self {
            key: [NONE; 2],
            extents,
            weights: Vec::new(),
            missing: 0.0,
            shares: Vec::new(),
        }
    }

    /// The cluster of one vertex.
    pub(super) fn of_vertex(model: &MorphModel, vertex: u32) -> Self {
        let extents = NodeExtents::of_vertex(model, vertex);
        match model.skin() {
            Some(skin) => Self::with_joints(skin, vertex, extents),
            None => Self::without_joints(extents),
        }
    }

    /// The cluster of one vertex with these extents.
    fn with_joints(skin: &Skin, vertex: u32, extents: NodeExtents) -> Self {
        let influences = skin.influences(vertex);
        let mut weights = summed(influences);
        let (missing, origin) = (1.0 - sum(influences), skin.joint_count() as u16);
        let is_missing = missing.abs() > MISSING;
        if is_missing {
            let (low, high) = outward(missing, influences.len());
            weights.push(Interval {
                joint: origin,
                low,
                high,
            });
        }
        let mut by_weight: Vec<(f32, u16)> = weights.iter().map(|w| (w.high, w.joint)).collect();
        by_weight.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let joint = |index: usize, least: f32| {
            let found = by_weight.get(index).filter(|(weight, _)| *weight > least);
            found.map_or(NONE, |(_, joint)| *joint)
        };
        Self {
            // A vertex without influences has weight 1 for the extra joint, which takes it to the origin.
            key: [joint(0, 0.0), joint(1, MIN_SECOND)],
            extents,
            shares: weights
                .iter()
                .filter(|w| w.joint != origin)
                .map(|w| (w.joint, w.high))
                .collect(),
            weights,
            missing: if is_missing || missing == 0.0 {
                0.0
            } else {
                outward(missing.abs(), influences.len()).1
            },
        }
    }

    pub(super) fn key(&self) -> [u16; 2] {
        self.key
    }

    /// The joint that maps the cluster. The other joints correct its image.
    pub(super) fn strongest(&self) -> u16 {
        self.key[0]
    }

    /// The joints other than the strongest, with their weights.
    pub(super) fn others(&self) -> impl Iterator<Item = &Interval> {
        self.weights.iter().filter(|weight| weight.joint != self.strongest())
    }

    /// Joins the clusters of a node's parts: those with the same key become one.
    pub(super) fn joined(mut parts: Vec<Self>) -> Vec<Self> {
        parts.sort_by_key(|cluster| cluster.key);
        parts.chunk_by(|a, b| a.key == b.key).map(Self::union).collect()
    }

    fn union(parts: &[Self]) -> Self {
        let mut joints: Vec<u16> = parts
            .iter()
            .flat_map(|part| part.weights.iter().map(|w| w.joint))
            .collect();
        joints.sort_unstable();
        joints.dedup();
        let weights = joints.into_iter().map(|joint| {
            let of = |part: &Self| {
                let found = part.weights.binary_search_by_key(&joint, |w| w.joint);
                found.map_or([0.0; 2], |index| [part.weights[index].low, part.weights[index].high])
            };
            let ends = parts.iter().map(of);
            let hull = |[low, high]: [f32; 2], [l, h]: [f32; 2]| [low.min(l), high.max(h)];
            let [low, high] = ends.fold([f32::INFINITY, f32::NEG_INFINITY], hull);
            Interval { joint, low, high }
        });
        let mut shares: Vec<(u16, f32)> = parts.iter().flat_map(|part| part.shares.iter().copied()).collect();
        shares.sort_by_key(|(joint, _)| *joint);
        let shares = shares
            .chunk_by(|a, b| a.0 == b.0)
            .map(|of| (of[0].0, of.iter().map(|(_, share)| share).sum()));
        Self {
            key: parts[0].key,
            extents: NodeExtents::of_parts(parts.iter().map(|part| &part.extents)),
            weights: weights.collect(),
            missing: parts.iter().map(|part| part.missing).fold(0.0, f32::max),
            shares: shares.collect(),
        }
    }
}

/// The weights of a vertex's joints, ascending by joint. A joint that occurs several times gets the sum.
fn summed(influences: &[Influence]) -> Vec<Interval> {
    let mut sorted = influences.to_vec();
    sorted.sort_by_key(|influence| influence.joint);
    let sums = sorted.chunk_by(|a, b| a.joint == b.joint).map(|of| {
        let (low, high) = match of {
            [one] => (one.weight, one.weight),
            several => outward(sum(several), several.len()),
        };
        Interval {
            joint: of[0].joint,
            low,
            high,
        }
    });
    sums.collect()
}

/// The sum of the weights. Returns exactly 1 only if the exact sum is 1.
fn sum(influences: &[Influence]) -> f64 {
    let terms = || influences.iter().map(|influence| f64::from(influence.weight));
    let sum: f64 = terms().sum();
    // Sums of numbers with 24 bits are exact in `f64` unless some are much smaller than others.
    let is_exact = terms().all(|weight| weight >= 1.0 / (1 << 24) as f64) && sum <= 8.0;
    if is_exact || sum != 1.0 { sum } else { sum.next_up() }
}

/// The `f32` numbers below and above a sum of weights, with room for its rounding.
fn outward(sum: f64, terms: usize) -> (f32, f32) {
    let rounding = sum_rounding(terms) * (1.0 + sum.abs());
    (crate::bounds::down(sum - rounding), crate::bounds::up(sum + rounding))
}

/// The shares of joints in the clusters of many vertices, added up vertex by vertex.
#[derive(Default)]
pub(super) struct Shares {
    /// By the keys of clusters, so that sums are rounded as in [`Cluster::joined`].
    of_clusters: BTreeMap<[u16; 2], BTreeMap<u16, f32>>,
}

impl Shares {
    pub(super) fn add(&mut self, skin: &Skin, vertex: u32) {
        let cluster = Cluster::with_joints(skin, vertex, NodeExtents::of_parts(std::iter::empty()));
        let sums = self.of_clusters.entry(cluster.key).or_default();
        for (joint, share) in cluster.shares {
            sums.entry(joint).and_modify(|sum| *sum += share).or_insert(share);
        }
    }

    /// The joint with the largest share, or [`NONE`].
    pub(super) fn dominant(&self) -> u16 {
        let all = self.of_clusters.values().flatten();
        largest(all.map(|(&joint, &share)| (joint, share)).collect())
    }
}

/// The joint with the largest share of a node, or [`NONE`] if no joint moves it.
pub(super) fn dominant<'c>(clusters: impl Iterator<Item = &'c Cluster>) -> u16 {
    largest(clusters.flat_map(|cluster| cluster.shares.iter().copied()).collect())
}

fn largest(mut shares: Vec<(u16, f32)>) -> u16 {
    shares.sort_by_key(|(joint, _)| *joint);
    let sums = shares
        .chunk_by(|a, b| a.0 == b.0)
        .map(|of| (of[0].0, of.iter().map(|(_, share)| share).sum::<f32>()));
    let largest = sums.fold((NONE, 0.0), |best, next| if next.1 > best.1 { next } else { best });
    largest.0
}
