use fearless_simd::Level;
use glam::Vec3;

use super::anchor::Anchor;
use super::blend::{blend_group, blend_patch, most_widening, move_anchored};
use super::cache::Stamped;
use crate::bounds::{Aabb, BoxLanes, LANES, with_simd};
use crate::model::MorphModel;
use crate::tree::{Child, CornerLanes, Leaf, LeafLanes, Tables, Topology, in_lanes, put};

/// How much a pose has blended in its life.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Blended {
    pub(crate) volumes: u64,
    pub(crate) vertices: u64,
}

/// A node by the group that it is a child of; good for every pose of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NodeId {
    pub(crate) group: u32,
    pub(crate) lane: u8,
}

/// A node as a traversal holds it: its place, which child it is, and where its box is in the pose's cache.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeRef {
    pub(crate) child: Child,
    pub(crate) slot: u32,
    pub(crate) id: NodeId,
}

/// A pose borrowed for a query: what traversals walk over.
#[derive(Debug)]
pub(crate) struct Posed<'a> {
    pub(crate) model: &'a MorphModel,
    pub(crate) topology: &'a Topology,
    pub(super) tables: &'a Tables,
    pub(super) leaf_lanes: Option<&'a LeafLanes>,
    pub(super) weights: &'a [f32],
    pub(super) anchor: Option<&'a Anchor>,
    pub(super) boxes: &'a mut Stamped<BoxLanes>,
    pub(super) vertices: &'a mut Stamped<Vec3>,
    pub(super) blended: &'a mut Blended,
    pub(super) scratch: &'a mut Scratch,
    /// The instructions to blend and to compare with.
    pub(crate) level: Level,
}

/// Memory that blending reuses.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    pub(super) corners: Vec<CornerLanes>,
    pub(super) points: Vec<Vec3>,
}

impl Posed<'_> {
    pub(crate) fn root(&mut self) -> NodeRef {
        let slot = self.open(0);
        self.node(slot, 0, 0)
    }

    /// Makes a group's boxes unless they are there; returns the slot to read them from.
    #[inline(always)]
    pub(crate) fn open(&mut self, group: usize) -> usize {
        match self.boxes.find(group) {
            Some(slot) => slot,
            None => self.make(group),
        }
    }

    /// Whether a group's boxes are there.
    pub(super) fn is_open(&self, group: usize) -> bool {
        self.boxes.find(group).is_some()
    }

    #[inline(never)]
    fn make(&mut self, group: usize) -> usize {
        self.blended.volumes += self.topology.group(group).children().len() as u64;
        let tables = self.tables.group(group);
        let slot = self.boxes.insert(group, BoxLanes::default());
        let boxes = self.boxes.get_mut(slot);
        match self.anchor {
            Some(anchor) => {
                with_simd!(self.level, simd => move_anchored(simd, tables, anchor.group(group), self.weights, boxes));
            }
            None => with_simd!(self.level, simd => blend_group(simd, tables, self.weights, boxes)),
        }
        slot
    }

    /// The boxes in a slot.
    #[inline]
    pub(crate) fn boxes(&self, slot: usize) -> &BoxLanes {
        self.boxes.get(slot)
    }

    /// A node's box, in model space.
    #[inline]
    pub(crate) fn node_box(&self, node: NodeRef) -> Aabb {
        self.boxes.get(node.slot as usize).get(usize::from(node.id.lane))
    }

    pub(crate) fn bounds(&mut self) -> Aabb {
        let root = self.root();
        self.node_box(root)
    }

    #[inline(always)]
    pub(crate) fn node(&self, slot: usize, group: usize, lane: usize) -> NodeRef {
        NodeRef {
            child: self.topology.group(group).child(lane),
            slot: slot as u32,
            id: NodeId {
                group: group as u32,
                lane: lane as u8,
            },
        }
    }

    /// A posed welded vertex; blended at the first call for these weights.
    #[inline(always)]
    pub(crate) fn vertex(&mut self, vertex: u32) -> Vec3 {
        match self.vertices.find(vertex as usize) {
            Some(slot) => *self.vertices.get(slot),
            None => self.blend_vertex(vertex),
        }
    }

    #[inline(never)]
    fn blend_vertex(&mut self, vertex: u32) -> Vec3 {
        self.blended.vertices += 1;
        let position = self.model.blend_vertex(vertex, self.weights);
        self.vertices.insert(vertex as usize, position);
        position
    }

    /// A triangle's posed corners, in model space.
    #[inline]
    pub(crate) fn corners(&mut self, triangle: u32) -> [Vec3; 3] {
        let [a, b, c] = self.model.triangle(triangle as usize);
        [self.vertex(a), self.vertex(b), self.vertex(c)]
    }

    /// Appends the posed corners of a leaf's triangles, in model space, eight triangles at a time.
    #[inline]
    pub(crate) fn leaf_corners(&mut self, leaf: Leaf, posed: &mut Vec<CornerLanes>) {
        let mesh = self.topology.leaf_mesh(leaf);
        let Some(lanes) = self.leaf_lanes else {
            return self.gather_corners(leaf, posed);
        };
        self.blended.vertices += mesh.vertices.len() as u64;
        for patch in lanes.patches(leaf.0, mesh.triangles.len()) {
            posed.extend_from_slice(std::slice::from_ref(patch.base));
            if let Some(corners) = posed.last_mut() {
                with_simd!(self.level, simd => blend_patch(simd, patch, self.weights, corners));
            }
        }
    }

    fn gather_corners(&mut self, leaf: Leaf, posed: &mut Vec<CornerLanes>) {
        let mesh = self.topology.leaf_mesh(leaf);
        let mut points = std::mem::take(&mut self.scratch.points);
        points.clear();
        points.extend(mesh.vertices.iter().map(|&vertex| self.vertex(vertex)));
        for triangles in mesh.corners.chunks(LANES) {
            let mut lanes = CornerLanes::default();
            for (lane, corners) in in_lanes(triangles) {
                for (corner, place) in corners.into_iter().enumerate() {
                    put(&mut lanes, lane, corner, points[usize::from(place)]);
                }
            }
            posed.push(lanes);
        }
        self.scratch.points = points;
    }

    /// How far boxes may be widened for rounding, if the pose has made the mesh much smaller than it is at rest; otherwise 0.
    #[inline]
    pub(crate) fn rounding(&self, size: f32) -> f32 {
        const MUCH: f32 = 512.0;
        if size * MUCH > self.model.base_reach() {
            return 0.0;
        }
        most_widening(self.model, self.weights)
    }

    pub(crate) fn blended(&self) -> Blended {
        *self.blended
    }
}
