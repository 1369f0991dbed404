//! Building: splits nodes from the top down and measures them from the bottom up, in one recursion.

use std::sync::Arc;

use super::extents::NodeExtents;
use super::sah::Partition;
use super::topology::{Child, Group};
use super::{BuildOptions, LeafLanes, MorphBvh, Tables, Topology};
use crate::bounds::{Kernel, LANES};
use crate::model::MorphModel;

/// The most levels of a tree, so that recursion never overflows the stack. Not measured; trees of real meshes have about ten.
pub(super) const MAX_DEPTH: usize = 256;
/// More levels than splitting by count takes: each one divides 2^31 triangles by eight.
const COUNT_DEPTH: usize = 33;

/// Decides how a node's triangles are divided among its children.
pub(super) trait Splits {
    /// Reorders a node's triangles child by child and returns the number of triangles of each child, `None` for a leaf.
    fn split(&mut self, triangles: &mut [u32], depth: usize) -> Option<Vec<usize>>;
}

impl Splits for Partition {
    fn split(&mut self, triangles: &mut [u32], depth: usize) -> Option<Vec<usize>> {
        if triangles.len() <= self.leaf_size {
            return None;
        }
        let counts = if depth + COUNT_DEPTH > MAX_DEPTH {
            Vec::new()
        } else {
            self.by_area(triangles)
        };
        if counts.len() > 1 {
            return Some(counts);
        }
        // No plane separates the midpoints.
        let chunks = triangles.chunks(triangles.len().div_ceil(LANES));
        Some(chunks.map(<[u32]>::len).collect())
    }
}

/// Replays the splits of a layout, whose triangles are already in order. The rest of its nodes.
pub(super) struct Recorded<'a>(pub(super) &'a [u32]);

impl Splits for Recorded<'_> {
    fn split(&mut self, _: &mut [u32], _: usize) -> Option<Vec<usize>> {
        let (&children, rest) = self.0.split_first()?;
        let (counts, rest) = rest.split_at_checked(children as usize)?;
        self.0 = rest;
        (children > 0).then(|| counts.iter().map(|&count| count as usize).collect())
    }
}

impl MorphBvh {
    /// Builds the tree.
    #[must_use]
    pub fn build(model: Arc<MorphModel>, options: &BuildOptions) -> Self {
        let triangles = (0..model.triangle_count() as u32).collect();
        let splits = Partition::new(&model, options.leaf_size());
        build_over(model, options, triangles, splits)
    }
}

/// Builds a tree over all triangles, given in any order.
pub(super) fn build_over(
    model: Arc<MorphModel>,
    options: &BuildOptions,
    mut triangles: Vec<u32>,
    splits: impl Splits,
) -> MorphBvh {
    let mut builder = Builder {
        model: &model,
        splits,
        topology: Topology::new(),
        tables: Tables::default(),
    };
    let above_root = builder.reserve();
    let (root, extents) = builder.node(&mut triangles, 0);
    builder.finish(above_root, &[root], &[extents]);
    let (mut topology, mut tables) = (builder.topology, builder.tables);
    tables.finish();
    topology.triangles = triangles;
    MorphBvh {
        leaf_lanes: LeafLanes::new(&model, &topology).map(Arc::new),
        model,
        topology: Arc::new(topology),
        tables: Arc::new(tables),
        options: *options,
        kernel: Kernel::default(),
    }
}

struct Builder<'a, S> {
    model: &'a MorphModel,
    splits: S,
    topology: Topology,
    tables: Tables,
}

impl<S: Splits> Builder<'_, S> {
    /// Builds the node over `triangles`, which it reorders. Returns it with what it spans.
    fn node(&mut self, triangles: &mut [u32], depth: usize) -> (Child, NodeExtents) {
        self.topology.depth = self.topology.depth.max(depth);
        let Some(counts) = self.splits.split(triangles, depth) else {
            return self.leaf(triangles);
        };
        let group = self.reserve();
        let mut rest = triangles;
        let build_child = |count| {
            let part = rest.split_off_mut(..count).unwrap_or_default();
            self.node(part, depth + 1)
        };
        let (children, extents): (Vec<_>, Vec<_>) = counts.into_iter().map(build_child).unzip();
        (Child::group(group), self.finish(group, &children, &extents))
    }

    fn leaf(&mut self, triangles: &[u32]) -> (Child, NodeExtents) {
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&triangle| self.model.corners(triangle)).collect();
        let leaf = self.topology.push_leaf(&corners);
        let vertices = self.topology.leaf_vertices(leaf).iter();
        let extents: Vec<_> = vertices
            .map(|&vertex| NodeExtents::of_vertex(self.model, vertex))
            .collect();
        (Child::leaf(leaf), NodeExtents::of_parts(&extents))
    }

    /// Takes the next number in preorder for a group whose children are not known yet.
    fn reserve(&mut self) -> usize {
        self.topology.groups.push(Group::default());
        self.tables.reserve();
        self.topology.groups.len() - 1
    }

    /// Stores the children of a group and returns what they span together.
    fn finish(&mut self, group: usize, children: &[Child], extents: &[NodeExtents]) -> NodeExtents {
        let slot = &mut self.topology.groups[group];
        slot.children[..children.len()].copy_from_slice(children);
        slot.len = children.len() as u8;
        let whole = NodeExtents::of_parts(extents);
        self.tables.fill(group, extents, &whole);
        whole
    }
}
