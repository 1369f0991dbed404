//! Traversals' access to a skinned mesh's pose: joints place its vertices, and its boxes are fitted to them, chunk by chunk.

use fearless_simd::prelude::*;
use glam::{DVec3, Vec3};

use super::chunk_boxes::around;
use super::posed::Posed;
use super::skin_tree::SkinTree;
use super::skinning::Skinning;
use crate::bounds::{Aabb, BoxLanes, LANES, WorldFromModel, with_simd};
use crate::exact::Triangle;
use crate::model::BLOCK;
use crate::tree::{ChildKind, CornerLanes, Leaf, Source, gather_from};

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
        let widening = skinning.widening();
        if widening.is_finite() {
            let (vertices, fitted) = (skinning.vertices.local(), &mut self.buffers.fitted);
            with_simd!(self.level, simd => fitted.fit(simd, self.topology, groups, vertices, widening, self.boxes));
        } else {
            for group in groups {
                let mut boxes = BoxLanes::default();
                boxes.set_all(&Aabb::UNBOUNDED);
                self.boxes.insert(group, boxes);
            }
        }
    }

    /// Fits all boxes to the posed vertices.
    pub(super) fn refit_skinned(&mut self) {
        let Some(tree) = self.skin_tree() else { return };
        self.boxes.next_epoch();
        for chunk in 0..tree.skin.chunks.len() {
            self.fit_chunk(chunk);
        }
        // In preorder, children come after their parents.
        let outer: Vec<usize> = tree.skin.chunks.outer_groups().collect();
        for &group in outer.iter().rev() {
            let mut boxes = BoxLanes::default();
            for (lane, child) in self.topology.group(group).children().iter().enumerate() {
                let bounds = match child.kind() {
                    ChildKind::Group(below) => {
                        let (slot, children) = (self.open(below), self.topology.group(below).children().len());
                        with_simd!(self.level, simd => self.boxes.get(slot).hull(simd, children))
                    }
                    ChildKind::Leaf(leaf) => self.skinned_leaf_box(leaf),
                };
                boxes.set(lane, &bounds);
            }
            self.blended.volumes += self.topology.group(group).children().len() as u64;
            self.boxes.insert(group, boxes);
        }
    }

    /// A tight box around a leaf's vertices in the body's frame.
    fn skinned_leaf_box(&mut self, leaf: Leaf) -> Aabb {
        let (topology, level) = (self.topology, self.level);
        let Some(skinning) = self.pose_leaf(leaf) else {
            return Aabb::UNBOUNDED;
        };
        let widening = skinning.widening();
        if widening.is_infinite() {
            return Aabb::UNBOUNDED;
        }
        let (vertices, positions) = (topology.leaf_vertices(leaf), skinning.vertices.local());
        let mut corners = [[0.0; 4]; 2];
        with_simd!(level, simd => {
            let [low, high] = around(simd, vertices, positions, widening);
            low.store_slice(&mut corners[0]);
            high.store_slice(&mut corners[1]);
        });
        let [min, max] = corners.map(|[x, y, z, _]| Vec3::new(x, y, z));
        Aabb { min, max }
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

    /// A box in the model space of an entity around a skinned mesh: the intersection of the box from one box per joint with the hull of
    /// those of the root's children.
    pub(super) fn skinned_bounds_in(&mut self, place: &WorldFromModel) -> Option<Aabb> {
        let (tree, top) = (self.skin_tree()?, self.top_group());
        let (Source::Outer(outer), (_, skinning)) = (tree.skin.chunks.source(top), self.skin.as_mut()?) else {
            return None;
        };
        let mut boxes = BoxLanes::default();
        let of_joints = skinning.bounds_in(tree, place, outer, &mut boxes);
        let children = self.topology.group(top).children().len();
        let of_children = with_simd!(self.level, simd => boxes.hull(simd, children));
        Some(of_children.intersection(&of_joints))
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
