//! Where a walk over a tree and itself starts, decided once per tree.
//!
//! Leaves that share a vertex always overlap, and so do all nodes above them. A walk from the root would open them in every frame, only to
//! find the same pairs of leaves again. So these pairs are listed, and walks start at the pairs of nodes below them that share no vertex.

use super::adjacency::{PatchPair, adjacent_leaves, adjacent_patches};
use super::topology::{ChildKind, NodeId, Topology};
use crate::model::MorphModel;

/// The pairs of nodes at which a walk over a tree and itself starts. Every pair of different leaves is below one of them, or listed as
/// neighbours.
#[derive(Clone, Debug, Default)]
pub(crate) struct SelfFront {
    /// The patches of leaves that share a vertex, and those of each leaf with itself.
    pub(crate) neighbours: Vec<PatchPair>,
    /// Nodes that share no vertex.
    pub(crate) apart: Vec<Apart>,
    /// Whether all leaves that share a vertex are listed. If not, some of those below `apart` do, too.
    pub(crate) is_complete: bool,
}

/// A node, and children of a group that are not below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Apart {
    /// The node, as a child of a group.
    pub(crate) node: NodeId,
    pub(crate) group: u32,
    /// The children, as a bit mask.
    pub(crate) mask: u8,
}

impl SelfFront {
    pub(super) fn new(model: &MorphModel, topology: &Topology) -> Self {
        let (mut leaves, is_complete) = adjacent_leaves(topology, model.vertex_count());
        Self {
            neighbours: adjacent_patches(model, topology, &leaves),
            apart: apart(topology, &mut leaves),
            is_complete,
        }
    }

    /// Whether there is nothing to compare.
    pub(crate) fn is_empty(&self) -> bool {
        self.neighbours.is_empty() && self.apart.is_empty()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.neighbours) + size_of_val(&*self.apart)
    }
}

/// Two nodes, or a node and itself, and the range of the adjacent leaves below them. The leaves of the first node come first in preorder.
struct Pair {
    nodes: [NodeId; 2],
    adjacent: std::ops::Range<usize>,
}

/// The topmost pairs of nodes without adjacent leaves. Reorders the adjacent leaves.
fn apart(topology: &Topology, adjacent: &mut [[u32; 2]]) -> Vec<Apart> {
    let mut found = Vec::new();
    let root = NodeId::ROOT;
    let mut rest = vec![Pair {
        nodes: [root; 2],
        adjacent: 0..adjacent.len(),
    }];
    while let Some(Pair {
        nodes: [a, b],
        adjacent: range,
    }) = rest.pop()
    {
        let (of_a, of_b) = (a.child(topology), b.child(topology));
        if a == b {
            let ChildKind::Group(group) = of_a.kind() else {
                continue;
            };
            let leaves = &mut adjacent[range.clone()];
            let siblings = first_leaves(topology, group);
            let lane_of = |leaf: u32| siblings.partition_point(|&first| first <= leaf) - 1;
            leaves.sort_unstable_by_key(|&[i, j]| (lane_of(i), lane_of(j)));
            let mut start = range.start;
            for i in 0..siblings.len() {
                let node = NodeId::new(group, i);
                let mut mask = 0;
                for j in i..siblings.len() {
                    let below = leaves[start - range.start..].iter();
                    let end = start + below.take_while(|&&[a, b]| (lane_of(a), lane_of(b)) == (i, j)).count();
                    if start == end {
                        mask |= 1 << j;
                    } else {
                        rest.push(Pair {
                            nodes: [node, NodeId::new(group, j)],
                            adjacent: start..end,
                        });
                    }
                    start = end;
                }
                found.extend(Apart::new(node, group, mask));
            }
            continue;
        }
        // Open the node with more leaves.
        let count = |node| topology.leaves_below(node).map(|leaf| leaf.0);
        let [[first_a, last_a], [first_b, last_b]] = [of_a, of_b].map(count);
        let opens_a = last_a - first_a >= last_b - first_b;
        let (node, ChildKind::Group(group)) = (if opens_a { (b, of_a.kind()) } else { (a, of_b.kind()) }) else {
            continue;
        };
        let leaves = &mut adjacent[range.clone()];
        let of_opened = |leaves: &[u32; 2]| leaves[usize::from(!opens_a)];
        leaves.sort_unstable_by_key(of_opened);
        let siblings = first_leaves(topology, group);
        let (mut start, mut mask) = (range.start, 0);
        for lane in 0..siblings.len() {
            let end = match siblings.get(lane + 1) {
                Some(&next) => range.start + leaves.partition_point(|pair| of_opened(pair) < next),
                None => range.end,
            };
            if start == end {
                mask |= 1 << lane;
            } else {
                let opened = NodeId::new(group, lane);
                rest.push(Pair {
                    nodes: if opens_a { [opened, node] } else { [node, opened] },
                    adjacent: start..end,
                });
            }
            start = end;
        }
        found.extend(Apart::new(node, group, mask));
    }
    found
}

impl Apart {
    /// `None` if there are no children.
    pub(super) fn new(node: NodeId, group: usize, mask: u8) -> Option<Self> {
        let group = group as u32;
        (mask != 0).then_some(Self { node, group, mask })
    }
}

/// The first leaf below each child of a group, ascending.
fn first_leaves(topology: &Topology, group: usize) -> Vec<u32> {
    let children = topology.group(group).children().iter();
    children
        .map(|&child| topology.leaves_below(child)[0].0 as u32)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::Arc;

    use glam::Vec3;
    use morph_collision_models::generated::random::{random_blob, triangle_soup};

    use super::*;
    use crate::bounds::{LANES, lanes_of};
    use crate::tree::{BuildOptions, MorphBvh};

    fn tree(positions: &[Vec3], triangles: &[[u32; 3]], leaf_size: usize) -> MorphBvh {
        let model = MorphModel::from_displacements::<[Vec3; 0]>(positions, triangles, &[]).unwrap();
        let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
        MorphBvh::build(Arc::new(model), &options)
    }

    /// Every pair of different leaves, once, whether as neighbours or below nodes that are apart. Returns the numbers of both.
    fn covers(bvh: &MorphBvh) -> [usize; 2] {
        let (topology, front) = (&bvh.topology, bvh.self_front());
        let mut seen = BTreeSet::new();
        let shares = |[a, b]: [usize; 2]| {
            let others = topology.leaf_vertices(super::super::Leaf(b));
            topology
                .leaf_vertices(super::super::Leaf(a))
                .iter()
                .any(|vertex| others.contains(vertex))
        };
        let first_patches = front.neighbours.iter().filter(|pair| pair.patches == [0; 2]);
        for pair in first_patches {
            let leaves = pair.leaves().map(|leaf| leaf.0);
            assert!(
                leaves[0] <= leaves[1] && shares(leaves) && seen.insert(leaves),
                "{leaves:?}"
            );
        }
        let neighbours = seen.len();
        for step in &front.apart {
            let [first, last] = topology.leaves_below(step.node.child(topology));
            for lane in lanes_of(step.mask) {
                let other = topology.leaves_below(topology.group(step.group as usize).child(lane));
                for a in first.0..=last.0 {
                    for b in other[0].0..=other[1].0 {
                        let leaves = [a.min(b), a.max(b)];
                        assert!(seen.insert(leaves), "{leaves:?} twice");
                        assert!(!front.is_complete || !shares(leaves), "{leaves:?}");
                    }
                }
            }
        }
        let leaves = topology.leaf_count();
        assert_eq!(seen.len(), leaves * (leaves + 1) / 2);
        [neighbours, seen.len() - neighbours]
    }

    #[test]
    fn every_pair_of_leaves_is_listed_once_and_those_that_share_a_vertex_as_neighbours() {
        for leaf_size in [1, 3, 8, 20] {
            let blob = random_blob(4, 2, 0, 0.0);
            let [neighbours, apart] = covers(&tree(&blob.positions, &blob.triangles, leaf_size));
            assert!(leaf_size == 20 || neighbours < apart, "{neighbours} {apart}");
            let soup = triangle_soup(5, 80, 0);
            let bvh = tree(&soup.positions, &soup.triangles, leaf_size);
            assert_eq!(covers(&bvh)[0], bvh.leaf_count(), "each with itself");
        }
        covers(&tree(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], 8));
    }

    #[test]
    fn triangles_of_neighbours_that_share_no_vertex_are_marked_once() {
        let blob = random_blob(4, 2, 0, 0.0);
        for leaf_size in [1, 8, 20] {
            let bvh = tree(&blob.positions, &blob.triangles, leaf_size);
            let (topology, model) = (&bvh.topology, bvh.model());
            let mut marked = BTreeSet::new();
            for pair in &bvh.self_front().neighbours {
                let [a, b] = pair.leaves().map(|leaf| topology.leaf_triangles(leaf));
                let [a, b] = [(a, 0), (b, 1)].map(|(of, i)| &of[LANES * usize::from(pair.patches[i])..]);
                for (i, &x) in a.iter().enumerate().take(LANES) {
                    let mask = PatchPair::unrelated_to(pair.unrelated, i);
                    for j in lanes_of(mask) {
                        assert!(marked.insert([x.min(b[j]), x.max(b[j])]));
                    }
                }
            }
            let mut expected = BTreeSet::new();
            for pair in bvh.self_front().neighbours.iter().filter(|pair| pair.patches == [0; 2]) {
                let [a, b] = pair.leaves().map(|leaf| topology.leaf_triangles(leaf));
                for (&x, &y) in a.iter().flat_map(|x| b.iter().map(move |y| (x, y))) {
                    if x != y && !model.corners(x).iter().any(|vertex| model.corners(y).contains(vertex)) {
                        expected.insert([x.min(y), x.max(y)]);
                    }
                }
            }
            assert_eq!(marked, expected);
        }
    }

    #[test]
    fn a_vertex_of_many_leaves_takes_no_quadratic_memory() {
        let rim = (0..4000).map(|i| Vec3::new((i as f32 * 0.1).cos(), (i as f32 * 0.1).sin(), i as f32));
        let positions: Vec<Vec3> = std::iter::once(Vec3::ZERO).chain(rim).collect();
        let triangles: Vec<[u32; 3]> = (1..4000).map(|i| [0, i, i + 1]).collect();
        let bvh = tree(&positions, &triangles, 8);
        covers(&bvh);
        let front = bvh.self_front();
        assert!(!front.is_complete && front.neighbours.len() < 4 * bvh.leaf_count());
    }
}
