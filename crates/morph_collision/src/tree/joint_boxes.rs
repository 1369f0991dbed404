//! One box per joint around the vertices that it moves, before joints move them. Together they bound a body before any node is blended.

use fearless_simd::Level;
use glam::Vec3;

use super::budget::{Budget, work_on};
use super::extents::NodeExtents;
use super::part_tables::{PartBlocks, PartTables};
use super::tables::GroupTables;
use super::topology::{Leaf, Topology};
use crate::bounds::{CenteredLanes, Extent, LANES, with_simd};
use crate::model::{MorphModel, Skin};

/// The boxes of all joints that move a vertex of a triangle, eight side by side.
#[derive(Clone, Default)]
pub(crate) struct JointBoxes {
    /// Joints of which targets move no vertex come first, so that few blocks have to be blended.
    joints: Vec<u16>,
    pub(crate) boxes: PartTables,
    pub(crate) blocks: PartBlocks,
    /// Those that have to be blended, without any weights.
    at_rest: Vec<CenteredLanes>,
    /// How far weights may move vertices along an axis while the boxes at rest, widened by as much, are used instead of blended ones.
    pub(crate) most_widening: f64,
}

/// The same relative to the largest side of the mesh. Most faces stay below, so whole characters are bounded without blending anything.
const MOST_WIDENING: f64 = 1.0 / 16.0;

impl JointBoxes {
    pub(super) async fn new(model: &MorphModel, skin: &Skin, topology: &Topology, budget: &Budget) -> Self {
        let mut moved: Vec<Option<NodeExtents>> = vec![None; skin.joint_count()];
        let mut is_used = vec![false; model.vertex_count()];
        for leaf in 0..topology.leaf_count() {
            let vertices = topology.leaf_vertices(Leaf(leaf));
            budget.spend(work_on(model, vertices.len())).await;
            for &vertex in vertices {
                if !std::mem::replace(&mut is_used[vertex as usize], true) {
                    let extents = NodeExtents::of_vertex(model, vertex);
                    for influence in skin.influences(vertex) {
                        extents.add_to(&mut moved[usize::from(influence.joint)]);
                    }
                }
            }
        }
        let mut boxes = Self::default();
        let mut children = Vec::new();
        let mut whole = Extent::EMPTY;
        let mut of_joints: Vec<(u16, NodeExtents)> = (0..)
            .zip(moved)
            .filter_map(|(joint, extents)| Some((joint, extents?)))
            .collect();
        of_joints.sort_by_key(|(joint, extents)| (!extents.targets.is_empty(), *joint));
        for (joint, extents) in of_joints {
            boxes.joints.push(joint);
            whole = whole.union(extents.base);
            children.push(extents);
        }
        boxes.joints.shrink_to_fit();
        boxes.blocks = boxes.boxes.add(&children);
        boxes.boxes.finish();
        for tables in boxes.boxes.moved(&boxes.blocks) {
            let mut at_rest = CenteredLanes::default();
            with_simd!(Level::baseline(), simd => at_rest.set(simd, tables.base));
            boxes.at_rest.push(at_rest);
        }
        boxes.at_rest.shrink_to_fit();
        boxes.most_widening = MOST_WIDENING * (whole.max - whole.min).max_element().max(0.0);
        boxes
    }

    /// The joints, eight at a time, with the tables that blend their boxes, if a target moves any of these.
    pub(crate) fn tables(&self) -> impl Iterator<Item = (&[u16], Option<GroupTables<'_>>)> {
        let still = self.boxes.still(&self.blocks).iter().map(|_| None);
        self.joints().zip(still.chain(self.boxes.moved(&self.blocks).map(Some)))
    }

    /// The joints, each with the middle of its box.
    pub(super) fn middles(&self) -> impl Iterator<Item = (u16, Vec3)> {
        let of_block = |boxes: &CenteredLanes| std::array::from_fn(|lane| boxes.get(lane).center.as_vec3());
        let middles = self.at_rest().into_iter().flatten().map(of_block);
        let all = middles.flat_map(<[Vec3; LANES]>::into_iter);
        self.joints.iter().copied().zip(all)
    }

    /// The boxes without any weights, eight at a time: those that no target moves, and then the others.
    #[inline(always)]
    pub(crate) fn at_rest(&self) -> [&[CenteredLanes]; 2] {
        [self.boxes.still(&self.blocks), &self.at_rest]
    }

    /// The joints, eight at a time.
    #[inline(always)]
    pub(crate) fn joints(&self) -> impl ExactSizeIterator<Item = &[u16]> {
        self.joints.chunks(LANES)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.joints) + self.boxes.bytes() + size_of_val(&*self.at_rest)
    }
}
