//! What bounds the nodes of a skinned mesh's tree whose vertices are not posed: for each child of a group above the chunks, a box for each
//! joint, around those of the child's vertices that the joint moves.

use std::ops::Range;

use super::budget::{Budget, work_on};
use super::chunks::Chunks;
use super::extents::NodeExtents;
use super::part_tables::{PartBlocks, PartTables};
use super::topology::{Child, Leaf, Topology};
use crate::bounds::{down, up};
use crate::model::{MorphModel, Skin, sum_rounding};

/// The children of the groups above the chunks.
#[derive(Clone, Default)]
pub(crate) struct OuterTables {
    /// In preorder.
    groups: Vec<OuterGroup>,
    /// One box for each part, group by group. A block of eight has parts of one group only.
    pub(crate) boxes: PartTables,
}

/// A group above the chunks.
#[derive(Clone, Debug, Default)]
pub(crate) struct OuterGroup {
    children: Vec<MovedChild>,
    /// Child by child. The joint that moves most of a child comes first.
    parts: Vec<MovedPart>,
    /// Its blocks of boxes.
    pub(crate) blocks: PartBlocks,
    /// The largest number of parts of a child.
    pub(crate) most_parts: usize,
}

#[derive(Clone, Debug, Default)]
struct MovedChild {
    parts: Range<u32>,
    missing: [f32; 2],
}

impl OuterGroup {
    /// The parts of each child, and the smallest and the largest difference of 1 and the sum of a vertex's weights.
    #[inline(always)]
    pub(crate) fn children(&self) -> impl Iterator<Item = (&[MovedPart], [f32; 2])> {
        let child = |MovedChild { parts, missing }: &MovedChild| {
            (&self.parts[parts.start as usize..parts.end as usize], *missing)
        };
        self.children.iter().map(child)
    }
}

/// The vertices of a child that a joint moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovedPart {
    pub(crate) joint: u16,
    /// The index of its box among those of the group. Boxes that targets move come last, so that few blocks have to be blended.
    pub(crate) index: u32,
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
        let mut seen = Seen::new(model.vertex_count());
        for group in chunks.outer_groups() {
            let children = topology.group(group).children();
            let (mut of_group, mut extents) = (OuterGroup::default(), Vec::new());
            // The box of a root whose children have such boxes is the hull of these.
            let is_hull = matches!(children, [root] if chunks.is_outer(*root));
            for node in if is_hull { &[] } else { children } {
                let vertices = vertices_below(topology, *node, &mut seen, budget).await;
                budget.spend(skin.joint_count()).await;
                let mut joints = Joints::new(skin);
                for vertices in vertices.chunks(PIECE) {
                    budget.spend(vertices.len()).await;
                    joints.count(skin, vertices);
                }
                joints.sort();
                for &vertex in &vertices {
                    budget.spend(work_on(model, 1)).await;
                    joints.add(model, skin, vertex);
                }
                joints.finish(skin, &mut of_group, &mut extents);
            }
            of_group.blocks = tables.add_boxes(&mut of_group.parts, extents);
            of_group.children.shrink_to_fit();
            of_group.parts.shrink_to_fit();
            tables.groups.push(of_group);
        }
        tables.boxes.finish();
        tables.groups.shrink_to_fit();
        tables
    }

    /// Stores the boxes of the parts of a group. Returns their blocks.
    fn add_boxes(&mut self, parts: &mut [MovedPart], extents: Vec<NodeExtents>) -> PartBlocks {
        let in_order = parts.iter_mut().zip(extents);
        let (still, moved): (Vec<_>, Vec<_>) = in_order.partition(|(_, extents)| extents.targets.is_empty());
        let mut extents = Vec::with_capacity(still.len() + moved.len());
        for (index, (part, of_part)) in (0..).zip(still.into_iter().chain(moved)) {
            part.index = index;
            extents.push(of_part);
        }
        self.boxes.add(&extents)
    }

    pub(crate) fn group_count(&self) -> usize {
        self.groups.len()
    }

    #[inline(always)]
    pub(crate) fn group(&self, outer: usize) -> &OuterGroup {
        &self.groups[outer]
    }

    pub(super) fn bytes(&self) -> usize {
        let of_group = |group: &OuterGroup| size_of_val(&*group.children) + size_of_val(&*group.parts);
        let groups: usize = self.groups.iter().map(of_group).sum();
        groups + size_of_val(&*self.groups) + self.boxes.bytes()
    }
}

/// The number of vertices that are counted in one piece of work.
const PIECE: usize = 256;

/// The vertices of which a node has been seen last.
struct Seen {
    last: Vec<u32>,
    node: u32,
}

impl Seen {
    fn new(vertices: usize) -> Self {
        Self {
            last: vec![0; vertices],
            node: 0,
        }
    }
}

/// The distinct vertices of the triangles below a node.
async fn vertices_below(topology: &Topology, node: Child, seen: &mut Seen, budget: &Budget) -> Vec<u32> {
    seen.node += 1;
    let mut vertices = Vec::new();
    let [first, last] = topology.leaves_below(node);
    for leaf in first.0..=last.0 {
        let of_leaf = topology.leaf_vertices(Leaf(leaf));
        budget.spend(of_leaf.len()).await;
        for &vertex in of_leaf {
            if std::mem::replace(&mut seen.last[vertex as usize], seen.node) != seen.node {
                vertices.push(vertex);
            }
        }
    }
    vertices
}

/// The parts of a child, while its vertices are added.
struct Joints {
    /// The sum of the weights of each joint.
    sums: Vec<f64>,
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
    fn new(skin: &Skin) -> Self {
        Self {
            sums: vec![0.0; skin.joint_count()],
            order: Vec::new(),
            index: vec![0; skin.joint_count()],
            shares: Vec::new(),
            extents: Vec::new(),
            missing: [f64::INFINITY, f64::NEG_INFINITY],
            weights: Vec::new(),
        }
    }

    /// Adds the weights of some vertices to the sums of their joints.
    fn count(&mut self, skin: &Skin, vertices: &[u32]) {
        for influence in vertices.iter().flat_map(|&vertex| skin.influences(vertex)) {
            self.sums[usize::from(influence.joint)] += f64::from(influence.weight);
        }
    }

    /// Sorts the joints, after all vertices have been counted.
    fn sort(&mut self) {
        let sum = |joint: u16| self.sums[usize::from(joint)];
        self.order = (0..self.sums.len() as u16).filter(|&joint| sum(joint) > 0.0).collect();
        self.order.sort_by(|&a, &b| sum(b).total_cmp(&sum(a)).then(a.cmp(&b)));
        for (at, joint) in self.order.iter().enumerate() {
            self.index[usize::from(*joint)] = at;
        }
        self.shares = vec![0.0; self.order.len()];
        self.extents = vec![None; self.order.len()];
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

    /// Adds the child to its group, and the extents of its parts.
    fn finish(self, skin: &Skin, group: &mut OuterGroup, extents: &mut Vec<NodeExtents>) {
        let rounding = sum_rounding(skin.most_influences());
        let first = group.parts.len();
        for ((joint, share), of_part) in self.order.into_iter().zip(self.shares).zip(self.extents) {
            // Every joint here moves a vertex.
            if let Some(of_part) = of_part {
                extents.push(of_part);
                // Rounded up, with room for the roundings of two sums and their quotient.
                let share = up(share * (1.0 + 8.0 * rounding)).min(1.0);
                group.parts.push(MovedPart { joint, index: 0, share });
            }
        }
        let parts = first as u32..group.parts.len() as u32;
        group.most_parts = group.most_parts.max(parts.len());
        let [least, most] = self.missing;
        group.children.push(MovedChild {
            parts,
            missing: [down(least), up(most)],
        });
    }
}
