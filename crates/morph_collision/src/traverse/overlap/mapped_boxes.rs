//! The boxes of a body, mapped to the frames in which a pair query compares them.

use fearless_simd::Simd;

use super::mapped_group::{FRAMES, MappedGroup};
use super::node::{BoxAt, Node};
use crate::bounds::{Aabb, FrameLanes, LANES, MovingLanes, with_simd};
use crate::pose::{BoxTree, EpochCache, PlacedBody};
use crate::traverse::mapping::Mapping;
use crate::tree::NodeId;

/// The boxes of one body that a query has looked at, in every frame. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct MappedBoxes {
    mappings: [Mapping; FRAMES],
    /// Number of frames added.
    used: usize,
    /// Converts lengths to the first body's units.
    scale: f32,
    /// Indexed by group.
    groups: EpochCache<MappedGroup>,
    /// The boxes at both ends of a motion, in the first frame. Indexed by slot of `groups`. Filled only if the tree's boxes move.
    moving: Vec<MovingLanes>,
}

impl MappedBoxes {
    /// Starts a query without frames, in which only the root is known.
    pub(super) fn begin(&mut self, of: &PlacedBody, scale: f32) {
        self.used = 0;
        self.scale = scale;
        self.groups.next_epoch();
        let slot = self.groups.claim(NodeId::ROOT.group as usize);
        let entry = self.groups.get_mut(slot);
        entry.children[0] = of.root;
        (entry.group, entry.mask, entry.len) = (NodeId::ROOT.group, 1, 1);
        entry.sizes.0[0] = of.bounds.girth() * scale;
        for frame in &mut entry.frames {
            frame.set(0, &Aabb::UNBOUNDED);
        }
    }

    /// Adds a frame and returns the root's box in it. If all frames are in use, replaces the last one.
    #[inline(always)]
    pub(super) fn push_frame<S: Simd>(&mut self, simd: S, frame: Option<&FrameLanes<S>>, bounds: &Aabb) -> Aabb {
        let index = self.used.min(FRAMES - 1);
        self.used += 1;
        self.mappings[index].set_lanes(simd, frame);
        let mapped = self.mappings[index].one(bounds);
        self.groups.get_mut(0).frames[index].set(0, &mapped);
        mapped
    }

    /// The number of frames in which boxes are compared.
    #[inline(always)]
    pub(super) fn frames(&self) -> usize {
        self.used.min(FRAMES)
    }

    /// The slot of a group's children. Blends and maps their boxes on the first call.
    #[inline(always)]
    pub(super) fn open(&mut self, tree: &mut impl BoxTree, group: usize) -> usize {
        match self.groups.find(group) {
            Some(slot) => slot,
            None => self.map_group(tree, group),
        }
    }

    #[inline(never)]
    fn map_group<T: BoxTree>(&mut self, tree: &mut T, group: usize) -> usize {
        with_simd!(tree.level(), simd => self.map_children(simd, tree, group))
    }

    #[inline(always)]
    fn map_children<S: Simd, T: BoxTree>(&mut self, simd: S, tree: &mut T, group: usize) -> usize {
        let slot = self.groups.claim(group);
        let entry = self.groups.get_mut(slot);
        let children = tree.topology().group(group);
        entry.children = *children.lanes();
        entry.group = group as u32;
        entry.mask = children.mask();
        entry.len = children.children().len() as u8;
        let blended = tree.open(group);
        let mappings = &self.mappings[..self.used.min(FRAMES)];
        entry.fill(simd, tree.boxes(blended), mappings, self.scale);
        if T::MOVES {
            self.map_moving(tree, blended, slot);
        }
        slot
    }

    #[inline(always)]
    pub(super) fn group(&self, slot: usize) -> &MappedGroup {
        self.groups.get(slot)
    }

    /// The node and its siblings.
    #[inline(always)]
    pub(super) fn group_of(&self, node: Node) -> &MappedGroup {
        self.groups.get(node.slot())
    }

    #[inline(always)]
    pub(super) fn size(&self, node: Node) -> f32 {
        self.group_of(node).sizes.0[node.lane()]
    }

    #[inline(always)]
    pub(super) fn child(&self, slot: usize, lane: usize) -> Node {
        Node::new(self.groups.get(slot).children[lane % LANES], slot, lane)
    }

    /// Prepares a walk over boxes that move: adds those of the root, which [`MappedBoxes::begin`] has only as a hull.
    pub(super) fn begin_moving(&mut self, tree: &mut impl BoxTree) {
        let root = tree.open(NodeId::ROOT.group as usize);
        self.map_moving(tree, root, 0);
    }

    /// The children in a slot that overlap a box of another body at some time, as a bit mask. Sets `enter` to lower bounds of these times.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(&self, simd: S, slot: usize, other: &Self, at: BoxAt, enter: &mut [f32; LANES]) -> u8 {
        self.moving[slot].meet(simd, &other.moving[at.slot], at.lane, enter)
    }

    fn map_moving(&mut self, tree: &impl BoxTree, boxes: usize, slot: usize) {
        if self.moving.len() <= slot {
            self.moving.resize_with(slot + 1, MovingLanes::default);
        }
        if let Some(ends) = tree.moving_boxes(boxes) {
            let mapped = &mut self.moving[slot];
            with_simd!(tree.level(), simd => {
                self.mappings[0].all(simd, &ends.start, &mut mapped.start);
                self.mappings[0].all(simd, &ends.end, &mut mapped.end);
            });
        }
    }

    pub(super) fn node(&mut self, tree: &mut impl BoxTree, id: NodeId) -> Node {
        let slot = self.open(tree, id.group as usize);
        self.child(slot, usize::from(id.lane))
    }

    pub(super) fn id(&self, node: Node) -> NodeId {
        NodeId {
            group: self.group_of(node).group,
            lane: node.lane() as u8,
        }
    }
}
