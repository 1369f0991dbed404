//! The tree of the rivals implemented here: groups triangles, with at most eight children per node.

use std::ops::Range;

/// A child of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    /// A group of children.
    Group(u32),
    /// A leaf, numbered in preorder.
    Leaf(u32),
}

/// The children of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    children: [Child; 8],
    len: u8,
    /// Edges from the root to the node whose children these are. Group 0, which holds only the root, also counts as
    /// depth 0.
    pub(super) depth: u8,
}

impl Group {
    pub(super) fn new(depth: usize) -> Self {
        Self {
            children: [Child::Leaf(0); 8],
            len: 0,
            depth: depth.min(usize::from(u8::MAX)) as u8,
        }
    }

    pub(super) fn push(&mut self, child: Child) {
        self.children[usize::from(self.len)] = child;
        self.len += 1;
    }

    #[inline]
    pub(super) fn children(&self) -> &[Child] {
        &self.children[..usize::from(self.len)]
    }
}

/// Groups and leaves in preorder; group 0 has one child, the root.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    pub(super) groups: Vec<Group>,
    /// Triangles of leaf `i` are at `leaf_starts[i]..leaf_starts[i + 1]`.
    pub(super) leaf_starts: Vec<u32>,
    /// Triangle numbers in leaf order.
    pub(super) triangles: Vec<u32>,
}

impl Tree {
    #[inline]
    pub(super) fn leaf(&self, leaf: u32) -> &[u32] {
        let leaf = leaf as usize;
        &self.triangles[self.leaf_starts[leaf] as usize..self.leaf_starts[leaf + 1] as usize]
    }

    pub(super) fn node_count(&self) -> u64 {
        self.groups.iter().map(|group| group.children().len() as u64).sum()
    }

    /// The triangles under a node: a range of `triangles`, because indices are in preorder.
    pub(super) fn under(&self, child: Child) -> Range<usize> {
        let start = self.leaf_starts[self.outermost_leaf(child, |group| group.children().first())] as usize;
        let end = self.leaf_starts[self.outermost_leaf(child, |group| group.children().last()) + 1] as usize;
        start..end
    }

    fn outermost_leaf(&self, mut child: Child, next: impl Fn(&Group) -> Option<&Child>) -> usize {
        loop {
            match child {
                Child::Leaf(leaf) => return leaf as usize,
                Child::Group(group) => match next(&self.groups[group as usize]) {
                    Some(&below) => child = below,
                    None => return 0,
                },
            }
        }
    }
}

/// The vertices under the children of some groups, each once.
#[derive(Clone, Debug)]
pub(super) struct VertexLists {
    /// Per group and lane.
    ranges: Vec<[(u32, u32); 8]>,
    vertices: Vec<u32>,
}

impl VertexLists {
    /// The lists of the children that `wanted` selects.
    pub(super) fn new(tree: &Tree, corners: &[[u32; 3]], wanted: impl Fn(&Group, Child) -> bool) -> Self {
        let mut lists = Self {
            ranges: vec![[(0, 0); 8]; tree.groups.len()],
            vertices: Vec::new(),
        };
        let mut unique = Vec::new();
        for (group, ranges) in tree.groups.iter().zip(&mut lists.ranges) {
            for (&child, range) in group.children().iter().zip(ranges) {
                if !wanted(group, child) {
                    continue;
                }
                unique.clear();
                let triangles = &tree.triangles[tree.under(child)];
                unique.extend(triangles.iter().flat_map(|&triangle| corners[triangle as usize]));
                unique.sort_unstable();
                unique.dedup();
                let start = lists.vertices.len() as u32;
                lists.vertices.extend_from_slice(&unique);
                *range = (start, lists.vertices.len() as u32);
            }
        }
        lists
    }

    #[inline]
    pub(super) fn of(&self, group: usize, lane: usize) -> &[u32] {
        let (start, end) = self.ranges[group][lane];
        &self.vertices[start as usize..end as usize]
    }
}
