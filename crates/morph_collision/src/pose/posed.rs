//! A pose, borrowed for a query, with its tree.

use fearless_simd::{Level, Simd};
use glam::{DVec3, Vec3, Vec3A, Vec4};

use super::blend::{blend_group, blend_patch};
use super::blended_vertices::BlendedVertices;
use super::box_source::BoxSource;
use super::cache::EpochCache;
use super::fitted_boxes::FittedBoxes;
use super::placed_body::PlacedBody;
use super::skinning::Skinning;
use crate::bounds::{Aabb, BoxLanes, LANES, Lanes, WorldFromModel, with_simd};
use crate::exact::Triangle;
use crate::model::{MorphModel, Weights, block_and_lane};
use crate::tree::{Child, CornerLanes, Leaf, LeafLanes, NodeId, SkinTables, Tables, Topology, gather_from};

/// The numbers of boxes and vertices that a pose has blended since it was created.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Blended {
    pub(crate) volumes: u64,
    pub(crate) vertices: u64,
}

/// A node as used by traversals: its id, its child entry, and the slot of its box in the pose's cache.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeRef {
    pub(crate) child: Child,
    pub(crate) slot: u32,
    pub(crate) id: NodeId,
}

/// A pose borrowed for a query. Traversals walk over it.
///
/// Boxes are in model space, which `world_from_model` takes to the world. The boxes of a skinned mesh are in the body's frame, which the
/// pose chooses, and joints place its vertices.
pub(crate) struct Posed<'a> {
    /// Takes the space of the boxes to world space.
    pub(crate) world_from_model: &'a WorldFromModel,
    pub(super) skin: Option<(&'a SkinTables, &'a mut Skinning)>,
    pub(crate) model: &'a MorphModel,
    pub(crate) topology: &'a Topology,
    pub(super) tables: &'a Tables,
    pub(super) leaf_lanes: Option<&'a LeafLanes>,
    pub(super) weights: &'a Weights,
    pub(super) boxes: &'a mut EpochCache<BoxLanes>,
    /// The vertices of a mesh without joints.
    pub(super) vertices: &'a mut BlendedVertices,
    pub(super) placed_body: &'a mut PlacedBody,
    pub(super) blended: &'a mut Blended,
    pub(super) fitted: &'a mut FittedBoxes,
    pub(super) source: &'a mut BoxSource,
    /// The SIMD level of the kernels.
    pub(crate) level: Level,
}

impl Posed<'_> {
    pub(crate) fn root(&mut self) -> NodeRef {
        let slot = self.open(0);
        self.node(slot, 0, 0)
    }

    /// Returns the slot of a group's boxes; blends them unless they are cached.
    #[inline(always)]
    pub(crate) fn open(&mut self, group: usize) -> usize {
        match self.boxes.find(group) {
            Some(slot) => slot,
            None => self.blend(group),
        }
    }

    /// Whether a group's boxes are cached.
    pub(super) fn is_open(&self, group: usize) -> bool {
        self.boxes.find(group).is_some()
    }

    #[inline(never)]
    fn blend(&mut self, group: usize) -> usize {
        if let Some(slot) = self.fit_instead(group) {
            return slot;
        }
        if self.skin.is_some() {
            return self.open_skinned(group);
        }
        with_simd!(self.level, simd => self.blend_boxes(simd, group))
    }

    #[inline(always)]
    fn blend_boxes<S: Simd>(&mut self, simd: S, group: usize) -> usize {
        self.blended.volumes += self.topology.group(group).children().len() as u64;
        let slot = self.boxes.claim(group);
        blend_group(simd, self.tables.group(group), self.weights, self.boxes.get_mut(slot));
        slot
    }

    /// The boxes in a slot of the cache.
    #[inline]
    pub(crate) fn boxes(&self, slot: usize) -> &BoxLanes {
        self.boxes.get(slot)
    }

    /// A node's box, in model space.
    #[inline]
    pub(crate) fn node_box(&self, node: NodeRef) -> Aabb {
        self.boxes.get(node.slot as usize).get(usize::from(node.id.lane))
    }

    #[inline(always)]
    pub(crate) fn node(&self, slot: usize, group: usize, lane: usize) -> NodeRef {
        NodeRef {
            child: self.topology.group(group).child(lane),
            slot: slot as u32,
            id: NodeId::new(group, lane),
        }
    }

    /// The position of a welded vertex before joints and placement. Blends its block unless it is cached.
    #[inline(always)]
    pub(crate) fn vertex(&mut self, vertex: u32) -> Vec3A {
        self.blend_block(block_and_lane(vertex).0);
        Vec3A::from_vec4(Vec4::from(self.vertices.points()[vertex as usize]))
    }

    /// Blends a block of vertices unless it is cached.
    #[inline(always)]
    fn blend_block(&mut self, block: usize) {
        self.blended.vertices += self.vertices.blend(self.level, self.model, block, self.weights);
    }

    /// The position of a welded vertex in model space; for a skinned mesh, in world space, rounded to `f32`.
    pub(crate) fn model_vertex(&mut self, vertex: u32) -> Vec3 {
        if self.is_skinned() {
            return self.skinned_vertex(vertex).as_vec3();
        }
        self.vertex(vertex).into()
    }

    /// The position of a welded vertex in world space.
    #[inline]
    pub(crate) fn world_vertex(&mut self, vertex: u32) -> DVec3 {
        if self.is_skinned() {
            return self.skinned_vertex(vertex);
        }
        let position = self.vertex(vertex);
        self.world_from_model.transform_point(position.into())
    }

    /// The corners of a triangle in world space.
    #[inline]
    pub(crate) fn world_triangle(&mut self, triangle: u32) -> Triangle {
        self.model.corners(triangle).map(|vertex| self.world_vertex(vertex))
    }

    /// Appends the corners of a leaf's triangles before joints and placement, in patches of eight triangles.
    pub(crate) fn leaf_corners(&mut self, leaf: Leaf, posed: &mut Vec<CornerLanes>) {
        let patches = self.topology.patches(leaf);
        for patch in patches.clone() {
            posed.push(CornerLanes::default());
            if let Some(corners) = posed.last_mut() {
                with_simd!(self.level, simd => self.patch_corners(simd, leaf, patch - patches.start, corners));
            }
        }
    }

    /// The corners of a leaf's patch before joints and placement. Unused lanes repeat the last triangle.
    #[inline(always)]
    pub(crate) fn patch_corners<S: Simd>(&mut self, simd: S, leaf: Leaf, patch: usize, corners: &mut CornerLanes) {
        if let Some(lanes) = self.leaf_lanes {
            if patch == 0 {
                self.blended.vertices += self.topology.leaf_vertices(leaf).len() as u64;
            }
            let columns = lanes.patch(self.topology.patches(leaf).start + patch);
            blend_patch(simd, columns, self.weights, corners);
        } else {
            self.gather_corners(simd, leaf, patch, corners);
        }
    }

    /// The corners of a leaf's patch in the space of the boxes, up to [`Posed::corner_error`]. Unused lanes repeat the last triangle.
    #[inline(always)]
    pub(crate) fn box_corners<S: Simd>(&mut self, simd: S, leaf: Leaf, patch: usize, corners: &mut CornerLanes) {
        if self.is_skinned() {
            self.skinned_corners(simd, leaf, patch, corners);
        } else {
            self.patch_corners(simd, leaf, patch, corners);
        }
    }

    /// By how much [`Posed::box_corners`] are rounded.
    pub(crate) fn corner_error(&self) -> f32 {
        self.skin.as_ref().map_or(0.0, |(_, skinning)| skinning.widening())
    }

    /// A leaf's triangle in world space, given the corners of its patch from [`Posed::box_corners`].
    #[inline(always)]
    pub(crate) fn patch_triangle(&self, leaf: Leaf, index: usize, corners: &CornerLanes) -> Triangle {
        if self.is_skinned() {
            return self.skinned_triangle(leaf, index);
        }
        let lane = index % LANES;
        let corner = |[x, y, z]: &[Lanes; 3]| {
            let posed = Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
            self.world_from_model.transform_point(posed)
        };
        let [a, b, c] = corners;
        [corner(a), corner(b), corner(c)]
    }

    #[inline(always)]
    fn gather_corners<S: Simd>(&mut self, simd: S, leaf: Leaf, patch: usize, corners: &mut CornerLanes) {
        let mesh = self.topology.leaf_mesh(leaf);
        // Vertices ascend, so those of a block follow each other.
        let mut last = usize::MAX;
        for &vertex in mesh.vertices {
            let (block, _) = block_and_lane(vertex);
            if block != last {
                last = block;
                self.blend_block(block);
            }
        }
        let first = patch * LANES;
        let triangles = &mesh.corners[first..mesh.corners.len().min(first + LANES)];
        gather_from(simd, triangles, mesh.vertices, self.vertices.points(), corners);
    }

    pub(crate) fn blended(&self) -> Blended {
        *self.blended
    }
}
