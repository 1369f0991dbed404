//! Arranges the clusters of a group's children side by side.

use super::clusters::{Cluster, Interval};
use crate::bounds::{LANES, Lanes};

/// A lane of a block: a child, and one of its clusters if there is one.
pub(super) type Lane<'c> = (usize, Option<&'c Cluster>);

/// Divides the clusters of a group's children into blocks, in one of two ways: block `i` has the `i`-th cluster of each child, or the
/// clusters of all children are sorted by their joints and cut into blocks. Returns whichever takes fewer instructions.
pub(super) fn arranged(children: &[Vec<Cluster>]) -> Vec<Vec<Lane<'_>>> {
    let most = children.iter().map(Vec::len).max().unwrap_or(0);
    let of_each = |place| {
        children
            .iter()
            .enumerate()
            .map(|(child, clusters)| (child, clusters.get(place)))
            .collect()
    };
    let by_child: Vec<Vec<Lane<'_>>> = (0..most).map(of_each).collect();
    let mut all: Vec<Lane<'_>> = Vec::new();
    for (child, clusters) in children.iter().enumerate() {
        all.extend(clusters.iter().map(|cluster| (child, Some(cluster))));
    }
    all.sort_by_key(|(_, cluster)| cluster.map(Cluster::key));
    let by_joint: Vec<Vec<Lane<'_>>> = all.chunks(LANES).map(<[_]>::to_vec).collect();
    let cost = |blocks: &[Vec<Lane<'_>>], scattering: usize| -> usize {
        let of_block = |lanes: &Vec<Lane<'_>>| {
            let Steps { pivots, rows } = steps(lanes);
            BLOCK + PIVOT * pivots.len() + ROW * rows.len() + scattering
        };
        blocks.iter().map(of_block).sum()
    };
    if cost(&by_joint, SCATTERING) < cost(&by_child, 0) {
        by_joint
    } else {
        by_child
    }
}

/// The instructions that the steps of the kernel take, counted once, with AVX2, and rounded.
const BLOCK: usize = 160;
const PIVOT: usize = 120;
const ROW: usize = 140;
const SCATTERING: usize = 190;

/// The joints of a block: the strongest one of each lane, and the weights of all others.
#[derive(Default)]
pub(super) struct Steps {
    pub(super) pivots: Vec<(u16, u8)>,
    pub(super) rows: Vec<(u16, [Lanes; 2])>,
}

pub(super) fn steps(lanes: &[Lane<'_>]) -> Steps {
    let mut steps = Steps::default();
    for (lane, (_, cluster)) in lanes.iter().enumerate() {
        let Some(cluster) = cluster else { continue };
        match steps.pivots.iter_mut().find(|(joint, _)| *joint == cluster.strongest()) {
            Some((_, lanes)) => *lanes |= 1 << lane,
            None => steps.pivots.push((cluster.strongest(), 1 << lane)),
        }
        for &Interval { joint, low, high } in cluster.others() {
            let place = steps
                .rows
                .iter()
                .position(|row| row.0 == joint)
                .unwrap_or(steps.rows.len());
            if place == steps.rows.len() {
                steps.rows.push((joint, [Lanes::default(); 2]));
            }
            let [lows, highs] = &mut steps.rows[place].1;
            (lows.0[lane], highs.0[lane]) = (low, high);
        }
    }
    steps
}
