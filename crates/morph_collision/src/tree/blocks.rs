//! Arranges the clusters of a group's children side by side.

use std::collections::BTreeMap;

use super::clusters::{Cluster, Interval};
use super::extents::TargetExtents;
use crate::bounds::{LANES, Lanes};

/// A lane of a block: a child, and one of its clusters if there is one.
pub(super) type Lane<'c> = (usize, Option<&'c Cluster>);

/// Divides the clusters of a group's children into blocks, in one of two ways: block `i` has the `i`-th cluster of each child, or
/// clusters that share joints come together. Returns whichever takes fewer instructions.
pub(super) fn arranged(children: &[Vec<Cluster>]) -> Vec<Vec<Lane<'_>>> {
    let most = children.iter().map(Vec::len).max().unwrap_or(0);
    let of_each = |index| {
        children
            .iter()
            .enumerate()
            .map(|(child, clusters)| (child, clusters.get(index)))
            .collect()
    };
    let by_child: Vec<Vec<Lane<'_>>> = (0..most).map(of_each).collect();
    let mut all: Vec<(usize, &Cluster)> = Vec::new();
    for (child, clusters) in children.iter().enumerate() {
        all.extend(clusters.iter().map(|cluster| (child, cluster)));
    }
    let by_joint = grouped(all);
    let cost = |blocks: &[Vec<Lane<'_>>], scattering: usize| -> usize {
        let of_block = |lanes: &Vec<Lane<'_>>| {
            let mut needs = Needs::default();
            let clusters = lanes.iter().filter_map(|lane| lane.1);
            BLOCK + scattering + clusters.map(|cluster| needs.add(cluster)).sum::<usize>()
        };
        blocks.iter().map(of_block).sum()
    };
    if cost(&by_joint, SCATTERING) < cost(&by_child, 0) {
        by_joint
    } else {
        by_child
    }
}

/// Divides the clusters of one child into blocks. Their boxes are one child's, so any lane will do: it is given as the child.
pub(super) fn spread(clusters: &[Cluster]) -> Vec<Vec<Lane<'_>>> {
    let mut blocks = grouped(clusters.iter().map(|cluster| (0, cluster)).collect());
    for lanes in &mut blocks {
        lanes.iter_mut().enumerate().for_each(|(lane, of)| of.0 = lane);
    }
    blocks
}

/// Blocks whose clusters share joints and targets. Each block takes, one by one, the cluster that adds the least, among the next few in
/// the order of their joints.
fn grouped(mut all: Vec<(usize, &Cluster)>) -> Vec<Vec<Lane<'_>>> {
    all.sort_by_key(|(_, cluster)| cluster.key());
    let mut blocks = Vec::with_capacity(all.len().div_ceil(LANES));
    let (mut rest, mut next) = (all.into_iter(), Vec::new());
    loop {
        let (mut block, mut needs) = (Vec::with_capacity(LANES), Needs::default());
        while block.len() < LANES {
            next.extend(rest.by_ref().take(CANDIDATES - next.len()));
            let candidates = next.iter().enumerate();
            let Some((index, _)) = candidates.min_by_key(|(_, (_, cluster))| needs.cost_of(cluster)) else {
                break;
            };
            let (child, cluster) = next.remove(index);
            needs.add(cluster);
            block.push((child, Some(cluster)));
        }
        if block.is_empty() {
            return blocks;
        }
        blocks.push(block);
    }
}

/// Bounds the work for groups with thousands of clusters.
const CANDIDATES: usize = 64;

/// The instructions that the kernel takes for a block, counted once, with AVX2, and rounded: for the block itself, for a target, for the
/// images of its boxes under a joint, for using these images in a pivot or a row, and for scattering the results. The kernel keeps the
/// images of four pivots; here, all count as kept.
const BLOCK: usize = 160;
const TARGET: usize = 30;
const IMAGE: usize = 80;
const PIVOT: usize = 40;
const ROW: usize = 60;
const SCATTERING: usize = 190;

/// The joints and targets that move a block.
#[derive(Default)]
struct Needs {
    pivots: Vec<u16>,
    /// Ascending.
    rows: Vec<u16>,
    /// Ascending.
    targets: Vec<u16>,
}

impl Needs {
    /// How many more instructions the block takes with this cluster.
    fn cost_of(&self, cluster: &Cluster) -> usize {
        let image = |is_there| if is_there { 0 } else { IMAGE };
        let has_row = |joint: &u16| self.rows.binary_search(joint).is_ok();
        let strongest = cluster.strongest();
        let pivot = if self.pivots.contains(&strongest) {
            0
        } else {
            PIVOT + image(has_row(&strongest))
        };
        let others = cluster.others().map(|weight| weight.joint);
        let rows = others.filter(|joint| !has_row(joint));
        let rows: usize = rows.map(|joint| ROW + image(self.pivots.contains(&joint))).sum();
        let is_new = |target: &&TargetExtents| self.targets.binary_search(&target.target).is_err();
        let targets = cluster.extents.targets.iter().filter(is_new).count();
        pivot + rows + TARGET * targets
    }

    /// Adds a cluster and returns its cost.
    fn add(&mut self, cluster: &Cluster) -> usize {
        let cost = self.cost_of(cluster);
        if !self.pivots.contains(&cluster.strongest()) {
            self.pivots.push(cluster.strongest());
        }
        self.rows.extend(cluster.others().map(|weight| weight.joint));
        self.rows.sort_unstable();
        self.rows.dedup();
        let targets = cluster.extents.targets.iter().map(|target| target.target);
        self.targets.extend(targets);
        self.targets.sort_unstable();
        self.targets.dedup();
        cost
    }
}

/// The joints of a block: the strongest one of each lane, and the weights of all others.
#[derive(Default)]
pub(super) struct Steps {
    pub(super) pivots: Vec<(u16, u8)>,
    pub(super) rows: Vec<(u16, [Lanes; 2])>,
}

pub(super) fn steps(lanes: &[Lane<'_>]) -> Steps {
    let mut steps = Steps::default();
    let mut indices = BTreeMap::new();
    for (lane, (_, cluster)) in lanes.iter().enumerate() {
        let Some(cluster) = cluster else { continue };
        match steps.pivots.iter_mut().find(|(joint, _)| *joint == cluster.strongest()) {
            Some((_, lanes)) => *lanes |= 1 << lane,
            None => steps.pivots.push((cluster.strongest(), 1 << lane)),
        }
        for &Interval { joint, low, high } in cluster.others() {
            let index = *indices.entry(joint).or_insert(steps.rows.len());
            if index == steps.rows.len() {
                steps.rows.push((joint, [Lanes::default(); 2]));
            }
            let [lows, highs] = &mut steps.rows[index].1;
            (lows.0[lane], highs.0[lane]) = (low, high);
        }
    }
    steps
}
