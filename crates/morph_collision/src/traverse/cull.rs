//! Volumes of two bodies compared in one frame.

use fearless_simd::{Level, Simd};
use glam::Vec3;

use crate::bounds::{Aabb, BoxLanes, CrossAxes, FrameSide, Frames, LANES, Slab, Volume, with_simd};
use crate::pose::{Blended, NodeRef, Place, Posed};
use crate::tree::Topology;

/// One of the two bodies of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    A,
    B,
}

/// A frame in which volumes of both bodies are compared; a side without a map is in its own space there.
#[derive(Debug)]
pub(crate) struct Cull<V: Volume> {
    a: Option<V::Map>,
    b: Option<V::Map>,
    /// What a length in this frame is at least in A's space.
    stretch: f64,
}

impl<V: Volume> Cull<V> {
    /// `None` if the frame is beyond `f32`; then it culls nothing.
    pub(crate) fn new(frames: &Frames) -> Option<Self> {
        let map = |frame: &Option<_>| match frame {
            Some(frame) => V::map(frame).map(Some),
            None => Some(None),
        };
        Some(Self {
            a: map(&frames.a)?,
            b: map(&frames.b)?,
            stretch: frames.stretch,
        })
    }

    /// A lower bound of the distance in A's space between two volumes, 0 or less where this frame does not part them.
    pub(crate) fn gap(&self, a: &V::One, b: &V::One) -> f64 {
        V::gap(&map_with::<V>(&self.a, a), &map_with::<V>(&self.b, b)) * self.stretch
    }

    /// Which of eight volumes of one side may share a point with a volume of the other, as far as this frame can tell.
    #[inline(always)]
    fn overlap_mask<S: Simd>(&self, simd: S, side: Side, volumes: &V, other: &V::One) -> u8 {
        let (own, others) = match side {
            Side::A => (&self.a, &self.b),
            Side::B => (&self.b, &self.a),
        };
        let mapped;
        let other = match others {
            Some(map) => {
                mapped = V::map_one(map, other);
                &mapped
            }
            None => other,
        };
        match own {
            Some(map) => volumes.mapped_overlap_mask(simd, map, other),
            None => volumes.overlap_mask(simd, other),
        }
    }

    pub(crate) fn overlap(&self, a: &V::One, b: &V::One) -> bool {
        V::overlap(&map_with::<V>(&self.a, a), &map_with::<V>(&self.b, b))
    }
}

fn map_with<V: Volume>(map: &Option<V::Map>, one: &V::One) -> V::One {
    map.as_ref().map_or(*one, |map| V::map_one(map, one))
}

/// The products of both bodies' axes, along which boxes that meet in every frame may still be apart.
#[derive(Debug)]
pub(crate) struct CrossCull {
    axes: CrossAxes,
    target: Side,
}

impl CrossCull {
    /// In the space of a body that can be inverted; `None` if neither can. `a` and `b` are the bodies' whole bounds.
    pub(crate) fn new(frames: &Frames, a: &Aabb, b: &Aabb) -> Option<Self> {
        let (frame, bounds, target) = match (&frames.a, &frames.b) {
            (None, Some(a_from_b)) => (a_from_b, a, Side::A),
            (Some(b_from_a), None) => (b_from_a, b, Side::B),
            _ => return None,
        };
        Some(Self {
            axes: CrossAxes::new(frame, bounds),
            target,
        })
    }

    /// Which of eight boxes of one side, out of `mask`, may meet a box of the other.
    pub(crate) fn overlap_mask(&self, level: Level, side: Side, boxes: &BoxLanes, other: &Aabb, mask: u8) -> u8 {
        let side = if side == self.target {
            FrameSide::Target
        } else {
            FrameSide::Source
        };
        with_simd!(level, simd => self.axes.overlap_mask(simd, side, boxes, other, mask))
    }
}

/// A posed tree whose nodes can be opened and compared as volumes of one kind.
pub(crate) trait Walkable {
    type Kind: Volume;

    fn topology(&self) -> &Topology;
    /// The posed corners of a triangle, in model space.
    fn corners(&mut self, triangle: u32) -> [Vec3; 3];
    fn blended(&self) -> Blended;
    fn root(&mut self) -> NodeRef;
    fn open(&mut self, group: usize) -> usize;
    fn volume(&self, node: NodeRef) -> <Self::Kind as Volume>::One;
    /// The children in an opened group's slot that no cull keeps from the other side's volume.
    fn overlap_mask(
        &self,
        slot: usize,
        culls: &[Cull<Self::Kind>],
        side: Side,
        other: &<Self::Kind as Volume>::One,
        mask: u8,
    ) -> u8;
    /// Boxes around the volumes in an opened group's slot.
    fn boxes(&self, slot: usize) -> BoxLanes;
    /// The instructions to compare with.
    fn level(&self) -> Level;

    #[inline]
    fn node(&self, slot: usize, group: usize, lane: usize) -> NodeRef {
        NodeRef {
            child: self.topology().group(group).children()[lane],
            slot: slot as u32,
            place: Place {
                group: group as u32,
                lane: lane as u8,
            },
        }
    }
}

#[inline(always)]
fn cull<S: Simd, V: Volume>(simd: S, volumes: &V, culls: &[Cull<V>], side: Side, other: &V::One, mut mask: u8) -> u8 {
    for cull in culls {
        if mask == 0 {
            break;
        }
        mask &= cull.overlap_mask(simd, side, volumes, other);
    }
    mask
}

impl<V: Volume> Walkable for Posed<'_, V> {
    type Kind = V;

    fn topology(&self) -> &Topology {
        self.topology
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

    #[inline]
    fn open(&mut self, group: usize) -> usize {
        Posed::open(self, group)
    }

    #[inline]
    fn volume(&self, node: NodeRef) -> V::One {
        Posed::volume(self, node)
    }

    #[inline]
    fn overlap_mask(&self, slot: usize, culls: &[Cull<V>], side: Side, other: &V::One, mask: u8) -> u8 {
        with_simd!(self.level, simd => cull(simd, self.volumes(slot), culls, side, other, mask))
    }

    fn boxes(&self, slot: usize) -> BoxLanes {
        self.all_bounds(slot)
    }

    fn level(&self) -> Level {
        self.level
    }
}

/// A posed tree of any kind of volume seen as boxes: how trees of different kinds are walked together, in code that is
/// compiled once.
pub(crate) struct AsBoxes<'a>(pub(crate) &'a mut dyn Boxes);

/// What [`AsBoxes`] asks of a posed tree.
pub(crate) trait Boxes {
    fn topology(&self) -> &Topology;
    fn corners(&mut self, triangle: u32) -> [Vec3; 3];
    fn blended(&self) -> Blended;
    fn root(&mut self) -> NodeRef;
    fn open(&mut self, group: usize) -> usize;
    fn bounds(&self, node: NodeRef) -> Slab<3>;
    fn all_bounds(&self, slot: usize) -> BoxLanes;
    fn level(&self) -> Level;
}

impl<V: Volume> Boxes for Posed<'_, V> {
    fn topology(&self) -> &Topology {
        self.topology
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
}

impl Walkable for AsBoxes<'_> {
    type Kind = BoxLanes;

    fn topology(&self) -> &Topology {
        self.0.topology()
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

    fn overlap_mask(&self, slot: usize, culls: &[Cull<BoxLanes>], side: Side, other: &Slab<3>, mask: u8) -> u8 {
        let boxes = self.0.all_bounds(slot);
        with_simd!(self.0.level(), simd => cull(simd, &boxes, culls, side, other, mask))
    }

    fn boxes(&self, slot: usize) -> BoxLanes {
        self.0.all_bounds(slot)
    }

    fn level(&self) -> Level {
        self.0.level()
    }
}
