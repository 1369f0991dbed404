//! What bounds each child of the root without blending its clusters: a box for each joint, around those of its vertices that the joint moves.

use std::collections::BTreeSet;

use super::clusters::Cluster;
use super::extents::NodeExtents;
use super::tables::{GroupTables, Tables};
use super::topology::Topology;
use crate::bounds::LANES;
use crate::model::{MorphModel, Skin, sum_rounding};

/// The children of the root, whose boxes are blended one by one.
#[derive(Clone, Default)]
pub(crate) struct RootChildren {
    /// The group of these children.
    pub(crate) group: usize,
    /// The number under which the first child's blocks are stored, as if the child were a group. The others follow.
    pub(crate) first: usize,
    pub(crate) children: Vec<MovedChild>,
    /// The joints that move any of them, ascending.
    pub(crate) joints: Vec<u16>,
    /// One box for each part, in the order of the children and of their parts.
    boxes: Tables,
    parts: usize,
}

/// The joints that move a child of the root.
#[derive(Clone, Debug, Default)]
pub(crate) struct MovedChild {
    /// The joint that moves most of the child comes first.
    pub(crate) parts: Vec<MovedPart>,
    /// The smallest and the largest difference of 1 and the sum of a vertex's weights.
    pub(crate) missing: [f32; 2],
}

/// The vertices of a child that a joint moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovedPart {
    /// The index of the joint in [`RootChildren::joints`].
    pub(crate) joint: u16,
    /// The largest weight of the joint, as a share of the sum of its weight and those of all earlier joints.
    pub(crate) share: f32,
}

impl RootChildren {
    /// Whether a box per child and joint is so much cheaper than the blended boxes, which take this many blocks, that blending the children one
    /// by one pays.
    pub(super) fn are_cheap(children: &[Vec<Cluster>], blocks: usize) -> bool {
        /// A part takes about 150 instructions and a block 2400, and a ray needs about a quarter of the blocks.
        const PARTS_PER_BLOCK: usize = 8;
        let parts = |clusters: &Vec<Cluster>| {
            let joints = clusters
                .iter()
                .flat_map(|cluster| cluster.weights.iter().map(|weight| weight.joint));
            joints.collect::<BTreeSet<_>>().len()
        };
        blocks >= 2 * children.len() && children.iter().map(parts).sum::<usize>() < PARTS_PER_BLOCK * blocks
    }

    /// `origin` is the number of the extra joint that takes every point to the world's origin.
    pub(super) fn new(group: usize, first: usize, children: &[Vec<Cluster>], origin: u16) -> Self {
        let child = |clusters: &Vec<Cluster>| MovedChild {
            missing: missing(clusters, origin),
            ..MovedChild::default()
        };
        Self {
            group,
            first,
            children: children.iter().map(child).collect(),
            ..Self::default()
        }
    }

    /// Measures the boxes.
    pub(super) fn finish(&mut self, model: &MorphModel, topology: &Topology, skin: &Skin) {
        let mut extents = Vec::new();
        for (child, node) in self.children.iter_mut().zip(topology.group(self.group).children()) {
            let mut vertices: Vec<u32> = topology
                .triangles_below(*node)
                .iter()
                .flat_map(|&t| model.corners(t))
                .collect();
            vertices.sort_unstable();
            vertices.dedup();
            for (part, of_part) in parts(model, skin, &vertices) {
                child.parts.push(part);
                extents.push(of_part);
            }
        }
        let parts = || self.children.iter().flat_map(|child| &child.parts);
        self.parts = extents.len();
        self.joints = parts().map(|part| part.joint).collect();
        self.joints.sort_unstable();
        self.joints.dedup();
        for part in self.children.iter_mut().flat_map(|child| &mut child.parts) {
            part.joint = self.joints.partition_point(|&joint| joint < part.joint) as u16;
        }
        for (block, extents) in extents.chunks(LANES).enumerate() {
            self.boxes.reserve();
            self.boxes.fill(block, extents, &NodeExtents::of_parts(extents.iter()));
        }
        self.boxes.finish();
    }

    /// The tables that blend the boxes of all parts, eight at a time.
    #[inline(always)]
    pub(crate) fn blocks(&self) -> impl Iterator<Item = GroupTables<'_>> {
        (0..self.parts.div_ceil(LANES)).map(|block| self.boxes.group(block))
    }

    pub(super) fn bytes(&self) -> usize {
        let parts: usize = self.children.iter().map(|child| size_of_val(&*child.parts)).sum();
        parts + size_of_val(&*self.children) + size_of_val(&*self.joints) + self.boxes.bytes()
    }
}

/// The parts of a child, and their extents before joints move them.
fn parts(model: &MorphModel, skin: &Skin, vertices: &[u32]) -> Vec<(MovedPart, NodeExtents)> {
    let mut order: Vec<(f64, u16)> = (0..skin.joint_count() as u16).map(|joint| (0.0, joint)).collect();
    for influence in vertices.iter().flat_map(|&vertex| skin.influences(vertex)) {
        order[usize::from(influence.joint)].0 += f64::from(influence.weight);
    }
    order.retain(|(weight, _)| *weight > 0.0);
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut index = vec![0; skin.joint_count()];
    for (at, (_, joint)) in order.iter().enumerate() {
        index[usize::from(*joint)] = at;
    }
    let mut shares = vec![0.0_f64; order.len()];
    let mut extents: Vec<Option<NodeExtents>> = vec![None; order.len()];
    for &vertex in vertices {
        let of_vertex = NodeExtents::of_vertex(model, vertex);
        let mut weights: Vec<(usize, f64)> = skin
            .influences(vertex)
            .iter()
            .map(|influence| (index[usize::from(influence.joint)], f64::from(influence.weight)))
            .collect();
        weights.sort_by_key(|(index, _)| *index);
        let mut sum = 0.0;
        for of_joint in weights.chunk_by(|a, b| a.0 == b.0) {
            let weight: f64 = of_joint.iter().map(|(_, weight)| weight).sum();
            sum += weight;
            let index = of_joint[0].0;
            shares[index] = shares[index].max(weight / sum);
            of_vertex.add_to(&mut extents[index]);
        }
    }
    let rounding = sum_rounding(skin.most_influences());
    let part = |((joint, share), extents): ((u16, f64), Option<NodeExtents>)| {
        // Rounded up, with room for the roundings of two sums and their quotient.
        let share = crate::bounds::up(share * (1.0 + 8.0 * rounding)).min(1.0);
        Some((MovedPart { joint, share }, extents?))
    };
    let joints = order.into_iter().map(|(_, joint)| joint);
    // Every joint here moves a vertex.
    joints.zip(shares).zip(extents).filter_map(part).collect()
}

/// The smallest and the largest difference of 1 and the sum of a vertex's weights.
fn missing(clusters: &[Cluster], origin: u16) -> [f32; 2] {
    let mut ends = [f32::INFINITY, f32::NEG_INFINITY];
    for cluster in clusters {
        let of_origin = cluster.weights.iter().find(|weight| weight.joint == origin);
        let (low, high) = of_origin.map_or((0.0, 0.0), |weight| (weight.low, weight.high));
        ends = [
            ends[0].min(low).min(-cluster.missing),
            ends[1].max(high).max(cluster.missing),
        ];
    }
    ends
}
