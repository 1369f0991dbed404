//! The boxes of a body as a pair query compares them.

use fearless_simd::Simd;

use crate::bounds::{Aabb, BoxLanes, BoxMap, LANES, Lanes, with_simd};
use crate::pose::{EpochCache, NodeId, Posed};
use crate::tree::Child;

/// Node pairs are compared in this many frames.
pub(crate) const FRAMES: usize = 2;

/// How a frame sees a body's boxes.
#[derive(Clone, Debug, Default)]
pub(super) enum View {
    /// The frame is the body's own space.
    #[default]
    Own,
    /// The frame is another space.
    Mapped(BoxMap),
    /// There is no frame: nothing is culled.
    Unbounded,
}

impl View {
    pub(super) fn one(&self, one: &Aabb) -> Aabb {
        match self {
            Self::Own => *one,
            Self::Mapped(map) => map.one(one),
            Self::Unbounded => Aabb::UNBOUNDED,
        }
    }

    #[inline(always)]
    fn all<S: Simd>(&self, simd: S, source: &BoxLanes, seen: &mut BoxLanes) {
        match self {
            Self::Own => *seen = *source,
            Self::Mapped(map) => map.all(simd, source, seen),
            Self::Unbounded => (0..LANES).for_each(|lane| seen.set(lane, &Aabb::UNBOUNDED)),
        }
    }
}

/// The children of a node in every frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Opened {
    frames: [BoxLanes; FRAMES],
    /// The sums of the boxes' sides, in the first body's units.
    sizes: Lanes,
    children: [Child; LANES],
    group: u32,
    pub(super) mask: u8,
    pub(super) len: u8,
}

impl Opened {
    #[inline(always)]
    fn fill<S: Simd>(&mut self, simd: S, boxes: &BoxLanes, views: &[View; FRAMES], scale: f32) {
        for (frame, view) in self.frames.iter_mut().zip(views) {
            view.all(simd, boxes, frame);
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

    /// Roughly how deep each child overlaps a child of another body.
    #[inline(always)]
    pub(super) fn depths<S: Simd>(&self, simd: S, other: &Self, lane: usize) -> [f32; LANES] {
        let mut depths = [0.0; LANES];
        self.frames[0].depths(simd, &other.frames[0].get(lane), &mut depths);
        depths
    }
}

/// A node of one body: its child entry, and where its box is in the body's [`Views`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub(super) child: Child,
    /// `LANES` times the slot of its siblings, plus its lane.
    at: u32,
}

impl Node {
    #[inline(always)]
    fn slot(self) -> usize {
        self.at as usize / LANES
    }

    #[inline(always)]
    pub(super) fn lane(self) -> usize {
        self.at as usize % LANES
    }
}

/// The boxes of one body that a query has looked at, in every frame. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct Views {
    pub(super) views: [View; FRAMES],
    /// The length of a length of 1 in the first body's units.
    pub(super) scale: f32,
    /// By group.
    opened: EpochCache<Opened>,
}

impl Views {
    /// Starts a query: forgets all boxes.
    pub(super) fn begin(&mut self, scale: f32) {
        self.views = [View::Unbounded, View::Unbounded];
        self.scale = scale;
        self.opened.next_epoch();
    }

    /// The slot of a group's children. Blends and maps their boxes on the first call.
    #[inline(always)]
    pub(super) fn open(&mut self, tree: &mut Posed<'_>, group: usize) -> usize {
        match self.opened.find(group) {
            Some(slot) => slot,
            None => self.make(tree, group),
        }
    }

    #[inline(never)]
    fn make(&mut self, tree: &mut Posed<'_>, group: usize) -> usize {
        let blended = tree.open(group);
        let children = tree.topology.group(group);
        let slot = self.opened.claim(group);
        let opened = self.opened.get_mut(slot);
        opened.children = *children.lanes();
        opened.group = group as u32;
        opened.mask = children.mask();
        opened.len = children.children().len() as u8;
        with_simd!(tree.level, simd => opened.fill(simd, tree.boxes(blended), &self.views, self.scale));
        slot
    }

    #[inline(always)]
    pub(super) fn opened(&self, slot: usize) -> &Opened {
        self.opened.get(slot)
    }

    /// The children that a node is one of.
    #[inline(always)]
    pub(super) fn siblings(&self, node: Node) -> &Opened {
        self.opened.get(node.slot())
    }

    #[inline(always)]
    pub(super) fn size(&self, node: Node) -> f32 {
        self.siblings(node).sizes.0[node.lane()]
    }

    #[inline(always)]
    pub(super) fn child(&self, slot: usize, lane: usize) -> Node {
        Node {
            child: self.opened.get(slot).children[lane % LANES],
            at: (slot * LANES + lane) as u32,
        }
    }

    pub(super) fn node(&mut self, tree: &mut Posed<'_>, id: NodeId) -> Node {
        let slot = self.open(tree, id.group as usize);
        self.child(slot, usize::from(id.lane))
    }

    pub(super) fn id(&self, node: Node) -> NodeId {
        NodeId {
            group: self.siblings(node).group,
            lane: node.lane() as u8,
        }
    }
}
