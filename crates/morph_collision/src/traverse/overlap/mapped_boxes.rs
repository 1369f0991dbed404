//! The boxes of a body, mapped to the frames in which a pair query compares them.

use fearless_simd::Simd;

use crate::bounds::{Aabb, BoxLanes, Frame, LANES, Lanes, MovingLanes, with_simd};
use crate::pose::{BoxTree, EpochCache, PlacedBody};
use crate::traverse::mapping::Mapping;
use crate::tree::{BODY_FRAME, Child, NodeId};

/// Node pairs are compared in this many frames.
const FRAMES: usize = 2;

/// How a skinned body's boxes, which are in the spaces of its joints, are mapped to the frames.
#[derive(Debug, Default)]
struct JointMappings {
    is_skinned: bool,
    /// The map from the body's space to each frame; `None` if they are the same space.
    frames: [Option<Frame>; FRAMES],
    /// Indexed by joint space.
    mappings: EpochCache<[Mapping; FRAMES]>,
}

impl JointMappings {
    fn begin(&mut self, is_skinned: bool) {
        self.is_skinned = is_skinned;
        if is_skinned {
            self.mappings.next_epoch();
        }
    }

    #[inline]
    fn push_frame(&mut self, index: usize, frame: Option<&Frame>) {
        if self.is_skinned {
            self.frames[index] = frame.copied();
        }
    }

    fn mappings(&mut self, tree: &mut impl BoxTree, frame: usize) -> &[Mapping; FRAMES] {
        let slot = self.mappings.find(frame).unwrap_or_else(|| {
            let to_body = tree.body_from_joint_frame(frame);
            let slot = self.mappings.claim(frame);
            for (mapping, frame) in self.mappings.get_mut(slot).iter_mut().zip(&self.frames) {
                match &to_body {
                    Some(to_body) => mapping.set(Some(&frame.as_ref().map_or(*to_body, |frame| frame.after(to_body)))),
                    None => mapping.set_unbounded(),
                }
            }
            slot
        });
        self.mappings.get(slot)
    }
}

/// The children of a node in every frame.
#[derive(Clone, Debug, Default)]
pub(super) struct MappedGroup {
    frames: [BoxLanes; FRAMES],
    /// The space in which the boxes were blended: that of a joint, or the body's.
    pub(super) space: usize,
    /// The boxes in that space. Not filled if neither body is skinned; then it only takes memory.
    pub(super) in_space: BoxLanes,
    /// The sums of the boxes' sides, in the first body's units.
    sizes: Lanes,
    children: [Child; LANES],
    group: u32,
    pub(super) mask: u8,
    pub(super) len: u8,
}

impl MappedGroup {
    #[inline(always)]
    fn fill<S: Simd>(&mut self, simd: S, boxes: &BoxLanes, mappings: &[Mapping], scale: f32) {
        for (frame, mapping) in self.frames.iter_mut().zip(mappings) {
            mapping.all(simd, boxes, frame);
        }
        for frame in &mut self.frames[mappings.len()..] {
            (0..LANES).for_each(|lane| frame.set(lane, &Aabb::UNBOUNDED));
        }
        boxes.girths(simd, scale, &mut self.sizes);
    }

    /// The children that overlap a child of another body in every frame, as a bit mask.
    #[inline(always)]
    pub(super) fn overlaps<S: Simd>(&self, simd: S, other: &Self, lane: usize) -> u8 {
        let mut mask = self.mask;
        for (own, other) in self.frames.iter().zip(&other.frames) {
            mask &= own.overlap_mask(simd, &other.get(lane));
            if mask == 0 {
                break;
            }
        }
        mask
    }

    /// A child's box in its own space.
    #[inline(always)]
    pub(super) fn own_box(&self, lane: usize) -> OwnBox {
        OwnBox {
            space: self.space,
            bounds: self.in_space.get(lane),
        }
    }

    /// Roughly how deep each child overlaps a child of another body.
    #[inline(always)]
    pub(super) fn depths<S: Simd>(&self, simd: S, other: &Self, lane: usize) -> [f32; LANES] {
        let mut depths = [0.0; LANES];
        self.frames[0].depths(simd, &other.frames[0].get(lane), &mut depths);
        depths
    }
}

/// Where the box of a node is: a slot of a body's [`MappedBoxes`], and a lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxAt {
    pub(super) slot: usize,
    pub(super) lane: usize,
}

/// A node of one body: its child entry, and the location of its box in the body's [`MappedBoxes`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub(super) child: Child,
    /// `LANES` times the slot of its siblings, plus its lane.
    at: u32,
}

impl Node {
    #[inline(always)]
    pub(super) fn slot(self) -> usize {
        self.at as usize / LANES
    }

    #[inline(always)]
    pub(super) fn lane(self) -> usize {
        self.at as usize % LANES
    }

    #[inline(always)]
    pub(super) fn box_at(self) -> BoxAt {
        BoxAt {
            slot: self.slot(),
            lane: self.lane(),
        }
    }
}

/// A box in the space in which it was blended.
#[derive(Clone, Copy)]
pub(super) struct OwnBox {
    pub(super) space: usize,
    pub(super) bounds: Aabb,
}

/// A pair of nodes, one of each body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NodePair {
    pub(super) a: Node,
    pub(super) b: Node,
}

impl NodePair {
    #[inline(always)]
    pub(super) fn are_leaves(self) -> bool {
        self.a.child.is_leaf() && self.b.child.is_leaf()
    }
}

/// The boxes of one body that a query has looked at, in every frame. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct MappedBoxes {
    mappings: [Mapping; FRAMES],
    joints: JointMappings,
    /// Whether either body is skinned, so that [`MappedGroup::in_space`] is needed.
    keeps_spaces: bool,
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
    /// Starts a query without frames, in which only the root is known. `any_skinned` says whether this body or the other one is skinned.
    pub(super) fn begin(&mut self, of: &PlacedBody, scale: f32, any_skinned: bool) {
        self.used = 0;
        self.joints.begin(of.is_skinned);
        self.keeps_spaces = any_skinned;
        self.scale = scale;
        self.groups.next_epoch();
        let slot = self.groups.claim(NodeId::ROOT.group as usize);
        let entry = self.groups.get_mut(slot);
        entry.children[0] = of.root;
        (entry.group, entry.mask, entry.len) = (NodeId::ROOT.group, 1, 1);
        entry.space = BODY_FRAME;
        if any_skinned {
            entry.in_space.set(0, &of.bounds);
        }
        for frame in &mut entry.frames {
            frame.set(0, &Aabb::UNBOUNDED);
        }
    }

    /// Adds a frame and returns the root's box in it. If all frames are in use, replaces the last one.
    pub(super) fn push_frame(&mut self, frame: Option<&Frame>, bounds: &Aabb) -> Aabb {
        let index = self.used.min(FRAMES - 1);
        self.used += 1;
        self.mappings[index].set(frame);
        self.joints.push_frame(index, frame);
        let mapped = self.mappings[index].one(bounds);
        let root = self.groups.get_mut(0);
        root.frames[index].set(0, &mapped);
        root.sizes.0[0] = bounds.girth() * self.scale;
        mapped
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
        let slot = self.groups.claim(group);
        let entry = self.groups.get_mut(slot);
        let children = tree.topology().group(group);
        entry.children = *children.lanes();
        entry.group = group as u32;
        entry.mask = children.mask();
        entry.len = children.children().len() as u8;
        let used = self.used.min(FRAMES);
        if let Some(own) = tree.open_in_joint_frame(group) {
            let mappings = &self.joints.mappings(tree, own.frame)[..used];
            if let Some(boxes) = tree.frame_boxes(own) {
                (entry.space, entry.in_space) = (own.frame, *boxes);
                with_simd!(tree.level(), simd => entry.fill(simd, boxes, mappings, self.scale));
            }
        } else {
            let blended = tree.open(group);
            entry.space = BODY_FRAME;
            if self.keeps_spaces {
                entry.in_space = *tree.boxes(blended);
            }
            with_simd!(tree.level(), simd => entry.fill(simd, tree.boxes(blended), &self.mappings[..used], self.scale));
            if T::MOVES {
                self.map_moving(tree, blended, slot);
            }
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
        Node {
            child: self.groups.get(slot).children[lane % LANES],
            at: (slot * LANES + lane) as u32,
        }
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
