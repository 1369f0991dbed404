//! Traversals' access to a skinned mesh's pose: its boxes are kept in the spaces of joints, and joints place its vertices.

use fearless_simd::Simd;
use glam::DVec3;

use super::posed::Posed;
use super::skin_tree::SkinTree;
use crate::bounds::{Aabb, BoxLanes, Extent, Frame, PlacedBounds, WorldFromModel, with_simd};
use crate::tree::{BODY_FRAME, ChildKind, Leaf, NodeId};

/// Boxes in the space of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameBoxes {
    /// The index of that space.
    pub(crate) frame: usize,
    slot: usize,
}

impl<'a> Posed<'a> {
    /// Whether joints place the vertices.
    #[inline(always)]
    pub(crate) fn is_skinned(&self) -> bool {
        self.skin.is_some()
    }

    /// Blends a group's boxes and maps them to the body's frame. Returns their slot in `boxes`.
    pub(super) fn open_skinned(&mut self, group: usize) -> usize {
        let mut boxes = BoxLanes::default();
        if group == 0 {
            boxes.set(0, &self.root_box());
        } else if !self.blend_children(group, &mut boxes) {
            self.open_in_body(group, &mut boxes);
        }
        self.boxes.insert(group, boxes)
    }

    fn root_box(&mut self) -> Aabb {
        match self.topology.group(0).child(0).kind() {
            ChildKind::Leaf(leaf) => self.skinned_leaf_box(leaf),
            ChildKind::Group(_) => self.bounds(),
        }
    }

    fn open_in_body(&mut self, group: usize, boxes: &mut BoxLanes) {
        let own = self.open_in_frame(group);
        if let (Some(FrameBoxes { frame, slot }), Some((_, skinning))) = (own, &mut self.skin) {
            skinning.in_body(self.level, frame, slot, boxes);
        }
    }

    /// Approximately by how much the boxes that the body's bounds are computed from were widened for rounding.
    pub(super) fn top_widening(&self) -> f32 {
        let group = self.top_group();
        self.skin
            .as_ref()
            .map_or(0.0, |(tables, skinning)| skinning.widening(tables, group))
    }

    /// Blends a group's boxes in the space of a joint; `None` if they are not kept in such a space.
    #[inline(always)]
    pub(crate) fn open_in_joint_frame(&mut self, group: usize) -> Option<FrameBoxes> {
        if self.skin.is_none() || self.is_refitted || group == 0 || self.is_one_by_one(group) {
            return None;
        }
        self.open_in_frame(group).filter(|boxes| boxes.frame != BODY_FRAME)
    }

    #[inline(never)]
    fn open_in_frame(&mut self, group: usize) -> Option<FrameBoxes> {
        let tree = self.skin_tree()?;
        let (tables, skinning) = self.skin.as_mut()?;
        let (slot, was_blended) = skinning.open(tree, group);
        if was_blended {
            self.blended.volumes += self.topology.group(group).children().len() as u64;
        }
        let frame = skinning.frame_of(tables, group);
        Some(FrameBoxes { frame, slot })
    }

    pub(crate) fn frame_boxes(&self, boxes: FrameBoxes) -> Option<&BoxLanes> {
        let (_, skinning) = self.skin.as_ref()?;
        Some(skinning.boxes(boxes.slot))
    }

    /// A box in world space around a skinned mesh, from one box per joint.
    pub(super) fn hull_of_joints(&mut self) -> Option<Aabb> {
        let tree = self.skin_tree()?;
        let (_, skinning) = self.skin.as_mut()?;
        Some(skinning.world_bounds(tree))
    }

    /// The same in the model space of `space`.
    pub(super) fn hull_of_joints_in(&mut self, space: &WorldFromModel) -> Option<Aabb> {
        let tree = self.skin_tree()?;
        let (_, skinning) = self.skin.as_mut()?;
        Some(skinning.bounds_in(tree, space))
    }

    /// The map from the space of a joint to the body's frame; `None` if it could not be computed.
    pub(crate) fn body_from_joint_frame(&mut self, frame: usize) -> Option<Frame> {
        let (_, skinning) = self.skin.as_mut()?;
        skinning.body_from_frame(frame)
    }

    /// The space of a joint as a body in the world; the body's own space for [`BODY_FRAME`], whether it is skinned or not.
    pub(crate) fn placed_space(&mut self, space: usize) -> PlacedBounds {
        match &self.skin {
            Some((_, skinning)) if space != BODY_FRAME => skinning.placed(space),
            _ => self.placed_body().placed,
        }
    }

    pub(super) fn skin_tree(&self) -> Option<SkinTree<'a>> {
        let (skin, _) = self.skin.as_ref()?;
        Some(SkinTree {
            model: self.model,
            skin,
            weights: self.weights,
            level: self.level,
        })
    }

    /// A node's box in the space in which it is kept, and the transform from that space to the world. The node's group must be open.
    pub(super) fn box_in_frame(&mut self, node: NodeId) -> Option<(Aabb, WorldFromModel)> {
        let (group, lane) = (node.group as usize, usize::from(node.lane));
        let slot = self.boxes.find(group)?;
        if self.is_refitted || group == 0 || self.is_one_by_one(group) {
            return self
                .skin
                .is_some()
                .then(|| (self.boxes.get(slot).get(lane), *self.world_from_model));
        }
        let FrameBoxes { frame, slot } = self.open_in_frame(group)?;
        let (_, skinning) = self.skin.as_ref()?;
        Some((skinning.boxes(slot).get(lane), skinning.world_from_frame(frame)))
    }

    /// The position of a vertex in world space.
    pub(super) fn skinned_vertex(&mut self, vertex: u32) -> DVec3 {
        let [x, y, z, _] = with_simd!(self.level, simd => self.place_vertex(simd, vertex));
        DVec3::new(x, y, z)
    }

    /// The positions of a leaf's vertices in world space. The fourth number of each is padding.
    pub(crate) fn world_vertices(&mut self, leaf: Leaf) -> &[[f64; 4]] {
        with_simd!(self.level, simd => self.place_vertices(simd, leaf));
        &self.buffers.world
    }

    #[inline(always)]
    fn place_vertices<S: Simd>(&mut self, simd: S, leaf: Leaf) {
        self.buffers.world.clear();
        for &vertex in self.topology.leaf_vertices(leaf) {
            let placed = self.place_vertex(simd, vertex);
            self.buffers.world.push(placed);
        }
    }

    #[inline(always)]
    fn place_vertex<S: Simd>(&mut self, simd: S, vertex: u32) -> [f64; 4] {
        let (Some(skin), Some((_, skinning))) = (self.model.skin(), &mut self.skin) else {
            return [0.0; 4];
        };
        if let Some(slot) = skinning.placed.find(vertex as usize) {
            return *skinning.placed.get(slot);
        }
        self.blended.vertices += 1;
        let position = self.model.blend_vertex(vertex, self.weights);
        let placed = skin.place(simd, vertex, position, &skinning.joints);
        skinning.placed.insert(vertex as usize, placed);
        placed
    }

    /// A tight box around a leaf's vertices in the body's frame.
    pub(super) fn skinned_leaf_box(&mut self, leaf: Leaf) -> Aabb {
        let mut extent = Extent::EMPTY;
        let world_from_body = self.world_from_model;
        for &[x, y, z, _] in self.world_vertices(leaf) {
            let (point, error) = world_from_body.model_point(DVec3::new(x, y, z));
            let of_point = Extent {
                min: point - error,
                max: point + error,
            };
            extent = extent.union(of_point);
        }
        extent.outward()
    }
}
