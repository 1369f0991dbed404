use std::ops::Range;
use std::sync::Arc;

use super::build::build;
use super::{BuildError, BuildOptions, GroupTables, Tables};
use crate::bounds::LANES;
use crate::model::MorphModel;

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
}

/// A bounding-volume tree for every pose of a [`MorphModel`]: immutable, shared by all instances of the mesh.
///
/// Each node holds its box at the base and, for each target that moves any of its vertices, how the ends of the box move;
/// a [`Pose`](crate::Pose) blends them when a query looks at the node. The tree is the paper's (Sect. 3): up to eight
/// children, split at the middle of a node's extents along all three axes.
///
/// Building takes `O(n log n)` time for `n` triangles, and memory in proportion to the sum over all nodes of the targets
/// that move them.
#[derive(Clone, Debug)]
pub struct MorphBvh {
    pub(super) model: Arc<MorphModel>,
    /// In preorder. Group 0 has one child: the root.
    pub(super) groups: Vec<Group>,
    pub(super) tables: Tables,
    /// Triangles of leaf `i` stand at `leaf_starts[i]..leaf_starts[i + 1]`; one more entry than leaves.
    pub(super) leaf_starts: Vec<u32>,
    /// The model's triangle numbers in leaf order.
    pub(super) triangles: Vec<u32>,
    pub(super) depth: usize,
}

impl MorphBvh {
    /// Builds the tree over the model's base shape.
    ///
    /// # Errors
    /// [`BuildError`] if an option is out of range.
    pub fn build(model: Arc<MorphModel>, options: &BuildOptions) -> Result<Self, BuildError> {
        build(model, options)
    }

    /// The mesh the tree was built over.
    #[must_use]
    pub fn model(&self) -> &Arc<MorphModel> {
        &self.model
    }

    /// How many nodes there are, leaves and root included.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.groups.iter().map(|group| usize::from(group.len)).sum()
    }

    /// How many of the nodes are leaves.
    #[must_use]
    pub fn leaf_count(&self) -> usize {
        self.leaf_starts.len() - 1
    }

    /// Edges on the longest way from the root to a leaf; 0 when the root is a leaf.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Bytes held on the heap, the model's not included.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.groups)
            + self.tables.bytes()
            + size_of_val(&*self.leaf_starts)
            + size_of_val(&*self.triangles)
    }

    pub(crate) fn group_count(&self) -> usize {
        self.groups.len()
    }

    #[inline]
    pub(crate) fn group(&self, group: usize) -> &Group {
        &self.groups[group]
    }

    #[inline]
    pub(crate) fn tables(&self, group: usize) -> GroupTables<'_> {
        self.tables.group(group)
    }

    /// The triangles of a leaf, as the model numbers them.
    #[inline]
    pub(crate) fn leaf_triangles(&self, leaf: Leaf) -> &[u32] {
        &self.triangles[self.leaf_range(leaf)]
    }

    fn leaf_range(&self, leaf: Leaf) -> Range<usize> {
        self.leaf_starts[leaf.0] as usize..self.leaf_starts[leaf.0 + 1] as usize
    }
}
