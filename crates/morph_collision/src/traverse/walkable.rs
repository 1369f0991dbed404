//! What a walk asks of a posed tree.

use fearless_simd::Level;
use glam::Vec3;

use crate::bounds::{BoxLanes, LANES, Slab, Volume};
use crate::pose::{Blended, NodeRef, Place, Posed};
use crate::tree::{CornerLanes, Leaf, Topology};

/// A posed tree whose nodes can be opened and compared as volumes of one kind.
pub(crate) trait Walkable {
    type Kind: Volume;

    fn topology(&self) -> &Topology;
    /// Appends the posed vertices of a leaf, in model space.
    fn leaf_vertices(&mut self, leaf: Leaf, posed: &mut Vec<Vec3>);
    /// Appends the posed corners of a leaf's triangles, in model space, eight triangles at a time.
    fn leaf_corners(&mut self, leaf: Leaf, posed: &mut Vec<CornerLanes>);
    /// The posed corners of a triangle, in model space.
    fn corners(&mut self, triangle: u32) -> [Vec3; 3];
    fn blended(&self) -> Blended;
    fn root(&mut self) -> NodeRef;
    fn open(&mut self, group: usize) -> usize;
    fn volume(&self, node: NodeRef) -> <Self::Kind as Volume>::One;
    /// The volumes in an opened group's slot; they may have to be made in `room`.
    fn volumes<'a>(&'a self, slot: usize, room: &'a mut Self::Kind) -> &'a Self::Kind;
    /// Boxes around the volumes in an opened group's slot.
    fn boxes(&self, slot: usize) -> BoxLanes;
    /// The instructions to compare with.
    fn level(&self) -> Level;
    /// How far volumes may be widened for rounding, for a mesh that is much smaller in this pose than at rest; otherwise 0.
    fn rounding(&self, size: f32) -> f32;

    #[inline(always)]
    fn node(&self, slot: usize, group: usize, lane: usize) -> NodeRef {
        NodeRef {
            child: self.topology().group(group).child(lane),
            slot: slot as u32,
            place: Place {
                group: group as u32,
                lane: lane as u8,
            },
        }
    }
}

impl<V: Volume> Walkable for Posed<'_, V> {
    type Kind = V;

    #[inline]
    fn topology(&self) -> &Topology {
        self.topology
    }

    #[inline]
    fn leaf_vertices(&mut self, leaf: Leaf, posed: &mut Vec<Vec3>) {
        Posed::leaf_vertices(self, leaf, posed);
    }

    fn leaf_corners(&mut self, leaf: Leaf, posed: &mut Vec<CornerLanes>) {
        Posed::leaf_corners(self, leaf, posed);
    }

    fn corners(&mut self, triangle: u32) -> [Vec3; 3] {
        Posed::corners(self, triangle)
    }

    fn blended(&self) -> Blended {
        Posed::blended(self)
    }

    fn root(&mut self) -> NodeRef {
        Posed::root(self)
    }

    #[inline(always)]
    fn open(&mut self, group: usize) -> usize {
        Posed::open(self, group)
    }

    #[inline]
    fn volume(&self, node: NodeRef) -> V::One {
        Posed::volume(self, node)
    }

    #[inline(always)]
    fn volumes<'a>(&'a self, slot: usize, _: &'a mut V) -> &'a V {
        Posed::volumes(self, slot)
    }

    fn boxes(&self, slot: usize) -> BoxLanes {
        self.all_bounds(slot)
    }

    #[inline]
    fn level(&self) -> Level {
        self.level
    }

    #[inline]
    fn rounding(&self, size: f32) -> f32 {
        Posed::rounding(self, size)
    }
}

/// A posed tree of any kind of volume seen as boxes: how trees of different kinds are walked together, in code that is
/// compiled once.
pub(crate) struct AsBoxes<'a>(pub(crate) &'a mut dyn Boxes);

/// What [`AsBoxes`] asks of a posed tree.
pub(crate) trait Boxes {
    fn topology(&self) -> &Topology;
    fn leaf_vertices(&mut self, leaf: Leaf, posed: &mut Vec<Vec3>);
    fn leaf_corners(&mut self, leaf: Leaf, posed: &mut Vec<CornerLanes>);
    fn corners(&mut self, triangle: u32) -> [Vec3; 3];
    fn blended(&self) -> Blended;
    fn root(&mut self) -> NodeRef;
    fn open(&mut self, group: usize) -> usize;
    fn bounds(&self, node: NodeRef) -> Slab<3>;
    fn all_bounds(&self, slot: usize) -> BoxLanes;
    fn level(&self) -> Level;
    fn rounding(&self, size: f32) -> f32;
}

impl<V: Volume> Boxes for Posed<'_, V> {
    fn topology(&self) -> &Topology {
        self.topology
    }

    fn leaf_vertices(&mut self, leaf: Leaf, posed: &mut Vec<Vec3>) {
        Posed::leaf_vertices(self, leaf, posed);
    }

    fn leaf_corners(&mut self, leaf: Leaf, posed: &mut Vec<CornerLanes>) {
        Posed::leaf_corners(self, leaf, posed);
    }

    fn corners(&mut self, triangle: u32) -> [Vec3; 3] {
        Posed::corners(self, triangle)
    }

    fn blended(&self) -> Blended {
        Posed::blended(self)
    }

    fn root(&mut self) -> NodeRef {
        Posed::root(self)
    }

    fn open(&mut self, group: usize) -> usize {
        Posed::open(self, group)
    }

    fn bounds(&self, node: NodeRef) -> Slab<3> {
        Slab::of_box(&V::bounds(&self.volume(node)))
    }

    fn all_bounds(&self, slot: usize) -> BoxLanes {
        let volumes = self.volumes(slot);
        let mut boxes = BoxLanes::default();
        for lane in 0..LANES {
            boxes.set(lane, &Slab::of_box(&V::bounds(&volumes.get(lane))));
        }
        boxes
    }

    fn level(&self) -> Level {
        self.level
    }

    fn rounding(&self, size: f32) -> f32 {
        Posed::rounding(self, size)
    }
}

impl Walkable for AsBoxes<'_> {
    type Kind = BoxLanes;

    fn topology(&self) -> &Topology {
        self.0.topology()
    }

    fn leaf_vertices(&mut self, leaf: Leaf, posed: &mut Vec<Vec3>) {
        self.0.leaf_vertices(leaf, posed);
    }

    fn leaf_corners(&mut self, leaf: Leaf, posed: &mut Vec<CornerLanes>) {
        self.0.leaf_corners(leaf, posed);
    }

    fn corners(&mut self, triangle: u32) -> [Vec3; 3] {
        self.0.corners(triangle)
    }

    fn blended(&self) -> Blended {
        self.0.blended()
    }

    fn root(&mut self) -> NodeRef {
        self.0.root()
    }

    fn open(&mut self, group: usize) -> usize {
        self.0.open(group)
    }

    fn volume(&self, node: NodeRef) -> Slab<3> {
        self.0.bounds(node)
    }

    fn volumes<'a>(&'a self, slot: usize, room: &'a mut BoxLanes) -> &'a BoxLanes {
        *room = self.0.all_bounds(slot);
        room
    }

    fn boxes(&self, slot: usize) -> BoxLanes {
        self.0.all_bounds(slot)
    }

    fn level(&self) -> Level {
        self.0.level()
    }

    fn rounding(&self, size: f32) -> f32 {
        self.0.rounding(size)
    }
}
