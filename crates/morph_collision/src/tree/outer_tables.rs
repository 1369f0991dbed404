//! What bounds the nodes of a skinned mesh's tree whose vertices are not posed: for each child of a group above the chunks, a box for each
//! joint, around those of the child's vertices that the joint moves.

use std::ops::Range;

use super::budget::Budget;
use super::chunks::Chunks;
use super::extents::NodeExtents;
use super::tables::{GroupTables, Tables};
use super::topology::Topology;
use crate::bounds::{LANES, down, up};
use crate::model::{MorphModel, Skin, sum_rounding};

/// The children of the groups above the chunks.
#[derive(Clone, Default)]
pub(crate) struct OuterTables {
    /// In preorder.
    groups: Vec<OuterGroup>,
    /// One box for each part, group by group. A block of eight has parts of one group only.
    boxes: Tables,
}

/// A group above the chunks.
#[derive(Clone, Debug, Default)]
pub(crate) struct OuterGroup {
    pub(crate) children: Vec<MovedChild>,
    /// Its blocks of boxes.
    blocks: Range<usize>,
}

/// The joints that move a child.
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
    pub(crate) joint: u16,
    /// Where its box is among those of the group. Boxes that targets move come last, so that few blocks have to be blended.
    pub(crate) place: u32,
    /// The largest weight of the joint, as a share of the sum of its weight and those of all earlier joints.
    pub(crate) share: f32,
}

impl OuterTables {
    pub(super) async fn new(
        model: &MorphModel,
        skin: &Skin,
        topology: &Topology,
        chunks: &Chunks,
        budget: &Budget,
    ) -> Self {
        let mut tables = Self::default();
        for group in chunks.outer_groups() {
            let mut extents = Vec::new();
            let mut of_group = OuterGroup::default();
            for node in topology.group(group).children() {
                let triangles = topology.triangles_below(*node);
                budget.spend(3 * triangles.len()).await;
                let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| model.corners(t)).collect();
                vertices.sort_unstable();
                vertices.dedup();
                let mut joints = Joints::new(skin, &vertices);
                for &vertex in &vertices {
                    budget.spend(super::build::work_on(model, 1)).await;
                    joints.add(model, skin, vertex);
                }
                let child = of_group.children.len();
                of_group.children.push(joints.finish(skin, child, &mut extents));
            }
            let (still, moved): (Vec<_>, Vec<_>) = extents
                .into_iter()
                .partition(|(of_part, _): &(NodeExtents, _)| of_part.targets.is_empty());
            let mut extents = Vec::with_capacity(still.len() + moved.len());
            for (place, (of_part, (child, part))) in (0..).zip(still.into_iter().chain(moved)) {
                of_group.children[child].parts[part].place = place;
                extents.push(of_part);
            }
            let first = tables.boxes.group_count();
            for extents in extents.chunks(LANES) {
                tables.boxes.reserve();
                let block = tables.boxes.group_count() - 1;
                tables
                    .boxes
                    .fill(block, extents, &NodeExtents::of_parts(extents.iter()));
            }
            of_group.blocks = first..tables.boxes.group_count();
            tables.groups.push(of_group);
        }
        tables.boxes.finish();
        tables.groups.shrink_to_fit();
        tables
    }

    pub(crate) fn group_count(&self) -> usize {
        self.groups.len()
    }

    #[inline(always)]
    pub(crate) fn group(&self, outer: usize) -> &OuterGroup {
        &self.groups[outer]
    }

    /// The tables that blend the boxes of all parts of a group, eight at a time.
    #[inline(always)]
    pub(crate) fn blocks(&self, outer: usize) -> impl Iterator<Item = GroupTables<'_>> {
        self.groups[outer].blocks.clone().map(|block| self.boxes.group(block))
    }

    pub(super) fn bytes(&self) -> usize {
        let children = || self.groups.iter().flat_map(|group| &group.children);
        let parts: usize = children().map(|child| size_of_val(&*child.parts)).sum();
        parts + size_of::<MovedChild>() * children().count() + size_of_val(&*self.groups) + self.boxes.bytes()
    }
}

/// The parts of a child, while its vertices are added.
struct Joints {
    /// The joints, the one with the largest sum of weights first.
    order: Vec<u16>,
    /// The index in `order` of each joint.
    index: Vec<usize>,
    shares: Vec<f64>,
    extents: Vec<Option<NodeExtents>>,
    missing: [f64; 2],
    weights: Vec<(usize, f64)>,
}

impl Joints {
    /// The joints of some vertices.
    fn new(skin: &Skin, vertices: &[u32]) -> Self {
        let mut sums = vec![0.0; skin.joint_count()];
        for influence in vertices.iter().flat_map(|&vertex| skin.influences(vertex)) {
            sums[usize::from(influence.joint)] += f64::from(influence.weight);
        }
        let mut order: Vec<u16> = (0..skin.joint_count() as u16).collect();
        order.retain(|&joint| sums[usize::from(joint)] > 0.0);
        order.sort_by(|&a, &b| sums[usize::from(b)].total_cmp(&sums[usize::from(a)]).then(a.cmp(&b)));
        let mut index = vec![0; skin.joint_count()];
        for (at, joint) in order.iter().enumerate() {
            index[usize::from(*joint)] = at;
        }
        Self {
            shares: vec![0.0; order.len()],
            extents: vec![None; order.len()],
            missing: [f64::INFINITY, f64::NEG_INFINITY],
            weights: Vec::new(),
            order,
            index,
        }
    }

    fn add(&mut self, model: &MorphModel, skin: &Skin, vertex: u32) {
        let of_vertex = NodeExtents::of_vertex(model, vertex);
        self.weights.clear();
        for influence in skin.influences(vertex) {
            let index = self.index[usize::from(influence.joint)];
            self.weights.push((index, f64::from(influence.weight)));
        }
        self.weights.sort_by_key(|(index, _)| *index);
        let mut sum = 0.0;
        for of_joint in self.weights.chunk_by(|a, b| a.0 == b.0) {
            let weight: f64 = of_joint.iter().map(|(_, weight)| weight).sum();
            sum += weight;
            let index = of_joint[0].0;
            self.shares[index] = self.shares[index].max(weight / sum);
            of_vertex.add_to(&mut self.extents[index]);
        }
        let missing = skin.missing(vertex);
        let [least, most] = &mut self.missing;
        (*least, *most) = (least.min(missing[0]), most.max(missing[1]));
    }

    /// Appends the extents of the parts, with the child's number and the part's.
    fn finish(self, skin: &Skin, child: usize, extents: &mut Vec<(NodeExtents, (usize, usize))>) -> MovedChild {
        let rounding = sum_rounding(skin.most_influences());
        let mut parts = Vec::with_capacity(self.order.len());
        for ((joint, share), of_part) in self.order.into_iter().zip(self.shares).zip(self.extents) {
            // Every joint here moves a vertex.
            if let Some(of_part) = of_part {
                extents.push((of_part, (child, parts.len())));
                // Rounded up, with room for the roundings of two sums and their quotient.
                let share = up(share * (1.0 + 8.0 * rounding)).min(1.0);
                parts.push(MovedPart { joint, place: 0, share });
            }
        }
        let [least, most] = self.missing;
        MovedChild {
            parts,
            missing: [down(least), up(most)],
        }
    }
}
