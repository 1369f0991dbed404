//! The nodes of a tree, in preorder, and the triangles and vertices of its leaves.

use std::ops::Range;

use crate::bounds::LANES;

/// A node, as an entry in its parent's group: the group of its own children, or a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Child(u32);

/// A decoded [`Child`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChildKind {
    Group(usize),
    Leaf(Leaf),
}

/// A leaf, numbered in preorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leaf(pub(crate) usize);

/// A node, named by its group and lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NodeId {
    pub(crate) group: u32,
    pub(crate) lane: u8,
}

impl NodeId {
    pub(crate) const ROOT: Self = Self { group: 0, lane: 0 };

    pub(crate) fn new(group: usize, lane: usize) -> Self {
        Self {
            group: group as u32,
            lane: lane as u8,
        }
    }

    pub(crate) fn child(self, topology: &Topology) -> Child {
        topology.group(self.group as usize).child(usize::from(self.lane))
    }
}

impl Child {
    const LEAF: u32 = 1 << 31;

    pub(super) fn group(index: usize) -> Self {
        Self(index as u32)
    }

    pub(super) fn leaf(leaf: Leaf) -> Self {
        Self(leaf.0 as u32 | Self::LEAF)
    }

    #[inline(always)]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    #[inline]
    pub(crate) fn kind(self) -> ChildKind {
        let index = (self.0 & !Self::LEAF) as usize;
        if self.0 & Self::LEAF == 0 {
            ChildKind::Group(index)
        } else {
            ChildKind::Leaf(Leaf(index))
        }
    }
}

/// The children of an inner node. There are at most eight, and they are blended and tested together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    children: [Child; LANES],
    len: u8,
}

impl Group {
    pub(super) fn set(&mut self, children: &[Child]) {
        self.children[..children.len()].copy_from_slice(children);
        self.len = children.len() as u8;
    }

    #[inline]
    pub(crate) fn children(&self) -> &[Child] {
        &self.children[..usize::from(self.len)]
    }

    /// All lanes. Those without a child hold the default.
    #[inline]
    pub(crate) fn lanes(&self) -> &[Child; LANES] {
        &self.children
    }

    #[inline]
    pub(crate) fn child(&self, lane: usize) -> Child {
        self.children[lane % LANES]
    }

    /// One set bit per child.
    #[inline]
    pub(crate) fn mask(&self) -> u8 {
        u8::MAX >> (LANES as u8 - self.len)
    }
}

/// The nodes and their triangles. Groups and leaves are in preorder, so a subtree is a contiguous range of each.
#[derive(Clone, Default)]
pub(crate) struct Topology {
    /// Group 0 has one child: the root.
    pub(super) groups: Vec<Group>,
    /// `leaf_starts[i]..leaf_starts[i + 1]` are the entries of leaf `i` in `triangles` and `corners`.
    leaf_starts: Vec<u32>,
    /// `patch_starts[i]..patch_starts[i + 1]` are the patches of leaf `i`. Each has eight triangles, except that the last may have fewer.
    patch_starts: Vec<u32>,
    /// The model's triangle numbers in leaf order.
    pub(super) triangles: Vec<u32>,
    /// `vertex_starts[i]..vertex_starts[i + 1]` are the entries of leaf `i` in `vertices`.
    vertex_starts: Vec<u32>,
    /// The distinct vertices of each leaf, ascending.
    vertices: Vec<u32>,
    /// The corners of each triangle as indices into its leaf's vertices.
    corners: Vec<[u16; 3]>,
    pub(crate) depth: usize,
}

/// The triangles of a leaf, indexing its distinct vertices.
#[derive(Clone, Copy)]
pub(crate) struct LeafMesh<'a> {
    pub(crate) vertices: &'a [u32],
    /// Indices into `vertices`, one entry per triangle.
    pub(crate) corners: &'a [[u16; 3]],
}

impl Topology {
    /// A topology without nodes.
    pub(super) fn new() -> Self {
        Self {
            leaf_starts: vec![0],
            patch_starts: vec![0],
            vertex_starts: vec![0],
            ..Self::default()
        }
    }

    pub(crate) fn group_count(&self) -> usize {
        self.groups.len()
    }

    #[inline]
    pub(crate) fn group(&self, group: usize) -> &Group {
        &self.groups[group]
    }

    /// The number of nodes, including the root and the leaves.
    pub(crate) fn node_count(&self) -> usize {
        // Every node is a leaf or has a group of children. Group 0 belongs to no node.
        self.leaf_count() + self.group_count() - 1
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    pub(crate) fn leaf_count(&self) -> usize {
        self.leaf_starts.len() - 1
    }

    /// The numbers of a leaf's patches.
    #[inline(always)]
    pub(crate) fn patches(&self, leaf: Leaf) -> Range<usize> {
        self.patch_starts[leaf.0] as usize..self.patch_starts[leaf.0 + 1] as usize
    }

    pub(super) fn patch_count(&self) -> usize {
        self.patch_starts.last().map_or(0, |&patches| patches as usize)
    }

    /// The model's numbers of a leaf's triangles.
    #[inline]
    pub(crate) fn leaf_triangles(&self, leaf: Leaf) -> &[u32] {
        &self.triangles[self.leaf_range(leaf)]
    }

    #[inline]
    pub(crate) fn leaf_mesh(&self, leaf: Leaf) -> LeafMesh<'_> {
        let range = self.leaf_range(leaf);
        LeafMesh {
            vertices: self.leaf_vertices(leaf),
            corners: &self.corners[range],
        }
    }

    /// The distinct vertices of a leaf, ascending.
    #[inline]
    pub(crate) fn leaf_vertices(&self, leaf: Leaf) -> &[u32] {
        &self.vertices[self.vertex_starts[leaf.0] as usize..self.vertex_starts[leaf.0 + 1] as usize]
    }

    /// The model's number of the triangle at a position in leaf order.
    #[inline(always)]
    pub(crate) fn triangle(&self, position: usize) -> u32 {
        self.triangles[position]
    }

    /// The positions of a leaf's triangles in leaf order.
    #[inline]
    pub(crate) fn leaf_range(&self, leaf: Leaf) -> Range<usize> {
        self.leaf_starts[leaf.0] as usize..self.leaf_starts[leaf.0 + 1] as usize
    }

    /// The model's numbers of the triangles below a node. Cost: the depth of the tree.
    pub(crate) fn triangles_below(&self, node: Child) -> &[u32] {
        let [first, last] = self.leaves_below(node);
        &self.triangles[self.leaf_range(first).start..self.leaf_range(last).end]
    }

    /// The vertices of all leaves below a node. Those that leaves share are repeated. Cost: the depth of the tree.
    pub(crate) fn vertices_below(&self, node: Child) -> &[u32] {
        let [first, last] = self.leaves_below(node);
        &self.vertices[self.vertex_starts[first.0] as usize..self.vertex_starts[last.0 + 1] as usize]
    }

    /// The first and the last leaf below a node.
    pub(crate) fn leaves_below(&self, node: Child) -> [Leaf; 2] {
        let leaf = |mut node: Child, lane: fn(&Group) -> usize| loop {
            match node.kind() {
                ChildKind::Leaf(leaf) => break leaf,
                ChildKind::Group(group) => node = self.group(group).child(lane(self.group(group))),
            }
        };
        [leaf(node, |_| 0), leaf(node, |group| group.children().len() - 1)]
    }

    /// A group and all groups below it. Cost: the depth of the tree.
    pub(super) fn groups_below(&self, group: usize) -> Range<usize> {
        let mut last = group;
        loop {
            let mut children = self.group(last).children().iter().rev();
            match children.find_map(|child| match child.kind() {
                ChildKind::Group(below) => Some(below),
                ChildKind::Leaf(_) => None,
            }) {
                Some(below) => last = below,
                None => return group..last + 1,
            }
        }
    }

    /// Releases the memory that was reserved for more nodes.
    pub(super) fn shrink_to_fit(&mut self) {
        self.groups.shrink_to_fit();
        self.leaf_starts.shrink_to_fit();
        self.patch_starts.shrink_to_fit();
        self.vertex_starts.shrink_to_fit();
        self.vertices.shrink_to_fit();
        self.corners.shrink_to_fit();
    }

    /// Adds the next leaf, given the corners of its triangles in the model.
    pub(super) fn push_leaf(&mut self, corners: &[[u32; 3]]) -> Leaf {
        let mut vertices: Vec<u32> = corners.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        // Fits in `u16`: at most 255 triangles have at most 765 vertices.
        let index = |vertex: u32| vertices.partition_point(|&other| other < vertex) as u16;
        self.corners.extend(corners.iter().map(|triangle| triangle.map(index)));
        self.vertices.extend_from_slice(&vertices);
        self.vertex_starts.push(self.vertices.len() as u32);
        self.leaf_starts.push(self.corners.len() as u32);
        let patches = self.patch_count() + corners.len().div_ceil(LANES);
        self.patch_starts.push(patches as u32);
        Leaf(self.leaf_count() - 1)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.groups)
            + size_of_val(&*self.leaf_starts)
            + size_of_val(&*self.patch_starts)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.vertex_starts)
            + size_of_val(&*self.vertices)
            + size_of_val(&*self.corners)
    }
}
