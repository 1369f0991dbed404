//! Traversals' access to a skinned mesh's pose: joints place its vertices, and its boxes are fitted to them, chunk by chunk.

use fearless_simd::prelude::*;
use glam::DVec3;

use super::posed::Posed;
use super::skin_tree::SkinTree;
use super::skinning::Skinning;
use crate::bounds::{Aabb, BoxLanes, LANES, WorldFromModel, with_simd};
use crate::exact::Triangle;
use crate::model::BLOCK;
use crate::tree::{CornerLanes, Leaf, Source, gather_from};

impl<'a> Posed<'a> {
    /// Whether joints place the vertices.
    #[inline(always)]
    pub(crate) fn is_skinned(&self) -> bool {
        self.skin.is_some()
    }

    /// Computes a group's boxes in the body's frame. Returns their slot in `boxes`.
    pub(super) fn open_skinned(&mut self, group: usize) -> usize {
        let Some(tree) = self.skin_tree() else {
            return self.boxes.claim(group);
        };
        let outer = match tree.skin.chunks.source(group) {
            Source::Chunk(chunk) => {
                self.fit_chunk(chunk);
                // `fit_chunk` stores the boxes of all groups of the chunk.
                return self.boxes.find(group).unwrap_or_else(|| self.boxes.claim(group));
            }
            Source::Outer(outer) => outer,
        };
        let mut boxes = BoxLanes::default();
        if group == 0 && self.top_group() > 0 {
            boxes.set(0, &self.bounds());
        } else if let Some((_, skinning)) = &mut self.skin {
            skinning.outer(tree, outer, &mut boxes);
        }
        self.blended.volumes += self.topology.group(group).children().len() as u64;
        self.boxes.insert(group, boxes)
    }

    /// Poses the vertices of a chunk and fits its boxes to them.
    fn fit_chunk(&mut self, chunk: usize) {
        let Some(tree) = self.skin_tree() else { return };
        let Some((_, skinning)) = &mut self.skin else { return };
        self.blended.vertices += skinning.pose_chunk(tree, chunk);
        let groups = tree.skin.chunks.chunk(chunk).groups();
        let boxes = groups.clone().map(|group| self.topology.group(group).children().len());
        self.blended.volumes += boxes.sum::<usize>() as u64;
        let (vertices, widening) = (skinning.vertices.local(), skinning.widening());
        let fitted = &mut *self.fitted;
        with_simd!(self.level, simd => fitted.fit(simd, self.topology, groups, vertices, widening, self.boxes));
    }

    /// Poses the vertices of a leaf, with all others of its chunk.
    #[inline]
    fn pose_leaf(&mut self, leaf: Leaf) -> Option<&Skinning> {
        let tree = self.skin_tree()?;
        let (_, skinning) = self.skin.as_mut()?;
        let chunk = tree.skin.chunks.of_leaf(leaf);
        self.blended.vertices += skinning.pose_chunk(tree, chunk);
        Some(skinning)
    }

    /// A box in world space around a skinned mesh, from one box per joint.
    pub(super) fn hull_of_joints(&mut self) -> Option<Aabb> {
        let tree = self.skin_tree()?;
        let (_, skinning) = self.skin.as_mut()?;
        Some(skinning.world_bounds(tree))
    }

    /// The same in the model space of an entity.
    pub(super) fn hull_of_joints_in(&mut self, place: &WorldFromModel) -> Option<Aabb> {
        let tree = self.skin_tree()?;
        let (_, skinning) = self.skin.as_mut()?;
        Some(skinning.bounds_in(tree, place))
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

    /// The position of a vertex in world space.
    pub(super) fn skinned_vertex(&mut self, vertex: u32) -> DVec3 {
        let vertex = vertex as usize;
        let (Some(tree), Some((_, skinning))) = (self.skin_tree(), &mut self.skin) else {
            return DVec3::ZERO;
        };
        self.blended.vertices += skinning.pose_block(tree, vertex / BLOCK);
        let [x, y, z, _] = skinning.vertices.world()[vertex];
        DVec3::new(x, y, z)
    }

    /// The world positions of a leaf's vertices, as indices of `world`. The fourth number of each position is padding.
    #[inline(always)]
    pub(crate) fn leaf_positions(&mut self, leaf: Leaf) -> LeafPositions<'_> {
        let vertices = self.topology.leaf_vertices(leaf);
        let world = self
            .pose_leaf(leaf)
            .map_or(&[][..], |skinning| skinning.vertices.world());
        LeafPositions { vertices, world }
    }

    /// The corners of a leaf's patch in the body's frame, rounded to `f32`. Unused lanes repeat the last triangle.
    #[inline(always)]
    pub(super) fn skinned_corners<S: Simd>(&mut self, simd: S, leaf: Leaf, patch: usize, corners: &mut CornerLanes) {
        let mesh = self.topology.leaf_mesh(leaf);
        let first = patch * LANES;
        let triangles = &mesh.corners[first..mesh.corners.len().min(first + LANES)];
        if let Some(skinning) = self.pose_leaf(leaf) {
            gather_from(simd, triangles, mesh.vertices, skinning.vertices.local(), corners);
        }
    }

    /// A triangle of a leaf in world space. The leaf must be posed.
    #[inline]
    pub(super) fn skinned_triangle(&self, leaf: Leaf, index: usize) -> Triangle {
        let Some((_, skinning)) = &self.skin else {
            return Triangle::default();
        };
        let (mesh, world) = (self.topology.leaf_mesh(leaf), skinning.vertices.world());
        let [a, b, c] = mesh.corners[index];
        let corner = |corner: u16| {
            let [x, y, z, _] = world[mesh.vertices[usize::from(corner)] as usize];
            DVec3::new(x, y, z)
        };
        [corner(a), corner(b), corner(c)]
    }
}

/// The posed vertices of a leaf.
#[derive(Clone, Copy)]
pub(crate) struct LeafPositions<'p> {
    pub(crate) vertices: &'p [u32],
    /// By vertex of the mesh.
    pub(crate) world: &'p [[f64; 4]],
}
