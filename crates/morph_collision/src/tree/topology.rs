use std::ops::Range;

use crate::bounds::LANES;

/// A node as its parent's group names it: a group of children of its own, or a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Child(u32);

/// A [`Child`] taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChildKind {
    Group(usize),
    Leaf(Leaf),
}

/// A leaf, numbered in preorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leaf(pub(crate) usize);

impl Child {
    const LEAF: u32 = 1 << 31;

    pub(super) fn group(index: usize) -> Self {
        Self(index as u32)
    }

    pub(super) fn leaf(index: usize) -> Self {
        Self(index as u32 | Self::LEAF)
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

/// The up to eight children of an inner node, which are blended and tested together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    pub(super) children: [Child; LANES],
    pub(super) len: u8,
}

impl Group {
    #[inline]
    pub(crate) fn children(&self) -> &[Child] {
        &self.children[..usize::from(self.len)]
    }

    #[inline]
    pub(crate) fn child(&self, lane: usize) -> Child {
        self.children[lane % LANES]
    }

    /// A bit per child.
    #[inline]
    pub(crate) fn mask(&self) -> u8 {
        u8::MAX >> (LANES as u8 - self.len)
    }
}

/// Which triangles are together: groups and leaves in preorder, so that a subtree is a contiguous range of each.
#[derive(Clone, Debug)]
pub(crate) struct Topology {
    /// Group 0 has one child: the root.
    pub(super) groups: Vec<Group>,
    /// Triangles of leaf `i` stand at `leaf_starts[i]..leaf_starts[i + 1]`; one more entry than leaves.
    pub(super) leaf_starts: Vec<u32>,
    /// The model's triangle numbers in leaf order.
    pub(super) triangles: Vec<u32>,
    /// The distinct vertices of leaf `i` stand at `vertex_starts[i]..vertex_starts[i + 1]`, ascending.
    pub(super) vertex_starts: Vec<u32>,
    pub(super) vertices: Vec<u32>,
    /// In leaf order, the corners of each triangle as places among its leaf's vertices.
    pub(super) corners: Vec<[u16; 3]>,
    pub(super) depth: usize,
}

/// The triangles of a leaf over its distinct vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafMesh<'a> {
    pub(crate) vertices: &'a [u32],
    /// Places among `vertices`, for each of `triangles`.
    pub(crate) corners: &'a [[u16; 3]],
    /// As the model numbers them.
    pub(crate) triangles: &'a [u32],
}

impl Topology {
    /// Of no nodes yet.
    pub(super) fn new() -> Self {
        Self {
            groups: Vec::new(),
            leaf_starts: vec![0],
            triangles: Vec::new(),
            vertex_starts: vec![0],
            vertices: Vec::new(),
            corners: Vec::new(),
            depth: 0,
        }
    }

    pub(crate) fn group_count(&self) -> usize {
        self.groups.len()
    }

    #[inline]
    pub(crate) fn group(&self, group: usize) -> &Group {
        &self.groups[group]
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    pub(crate) fn leaf_count(&self) -> usize {
        self.leaf_starts.len() - 1
    }

    /// The triangles of a leaf, as the model numbers them.
    #[inline]
    pub(crate) fn leaf_triangles(&self, leaf: Leaf) -> &[u32] {
        &self.triangles[self.leaf_range(leaf)]
    }

    pub(super) fn leaves(&self) -> impl Iterator<Item = Leaf> {
        (0..self.leaf_count()).map(Leaf)
    }

    #[inline]
    pub(crate) fn leaf_mesh(&self, leaf: Leaf) -> LeafMesh<'_> {
        let range = self.leaf_range(leaf);
        LeafMesh {
            vertices: self.leaf_vertices(leaf),
            corners: &self.corners[range.clone()],
            triangles: &self.triangles[range],
        }
    }

    /// Adds the next leaf, of triangles with these corners in the model.
    pub(super) fn push_leaf(&mut self, corners: &[[u32; 3]]) -> Leaf {
        let leaf = Leaf(self.leaf_starts.len() - 1);
        let mut vertices: Vec<u32> = corners.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        // At most three for each of 255 triangles.
        let place = |vertex: u32| vertices.binary_search(&vertex).unwrap_or(0) as u16;
        self.corners.extend(corners.iter().map(|triangle| triangle.map(place)));
        self.vertices.extend_from_slice(&vertices);
        self.vertex_starts.push(self.vertices.len() as u32);
        self.leaf_starts.push(self.corners.len() as u32);
        leaf
    }

    /// The distinct vertices of a leaf, ascending.
    pub(super) fn leaf_vertices(&self, leaf: Leaf) -> &[u32] {
        &self.vertices[self.vertex_starts[leaf.0] as usize..self.vertex_starts[leaf.0 + 1] as usize]
    }

    /// Where the triangles below a node stand in [`Topology::triangles_at`]. Cost: the depth of the tree.
    pub(crate) fn range_below(&self, node: Child) -> Range<usize> {
        let end = |pick: fn(&[Child]) -> Option<&Child>| {
            let mut node = node;
            loop {
                match node.kind() {
                    ChildKind::Leaf(leaf) => return self.leaf_range(leaf),
                    ChildKind::Group(group) => match pick(self.group(group).children()) {
                        Some(child) => node = *child,
                        None => return 0..0,
                    },
                }
            }
        };
        end(<[Child]>::first).start..end(<[Child]>::last).end
    }

    /// The model's triangle numbers in a range of the order of leaves.
    pub(crate) fn triangles_at(&self, range: Range<usize>) -> &[u32] {
        &self.triangles[range]
    }

    pub(super) fn leaf_range(&self, leaf: Leaf) -> Range<usize> {
        self.leaf_starts[leaf.0] as usize..self.leaf_starts[leaf.0 + 1] as usize
    }

    pub(super) fn node_count(&self) -> usize {
        self.groups.iter().map(|group| usize::from(group.len)).sum()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.groups)
            + size_of_val(&*self.leaf_starts)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.vertex_starts)
            + size_of_val(&*self.vertices)
            + size_of_val(&*self.corners)
    }
}
