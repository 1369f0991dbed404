//! Top-down topology, bottom-up extents, in one recursion.

use std::sync::Arc;

use super::extents::NodeExtents;
use super::partition::Partition;
use super::topology::{Child, Group};
use super::{BuildError, BuildOptions, LeafLanes, MorphBvh, Tables, Topology};
use crate::bounds::{Kernel, LANES};
use crate::model::MorphModel;

/// Deeper nodes are split by count, so that no mesh makes a tree too deep to recurse into.
pub(super) const MOST_DEPTH: usize = 256;

/// Decides how a node's triangles are shared out among its children.
pub(super) trait Splits {
    /// Reorders a node's triangles child by child and returns the children's lengths, `None` for a leaf.
    fn split(&mut self, triangles: &mut [u32], depth: usize) -> Option<Vec<usize>>;
}

/// Splits by the surface-area heuristic, down to leaves of a size.
struct ByArea {
    partition: Partition,
    leaf_size: usize,
}

impl Splits for ByArea {
    fn split(&mut self, triangles: &mut [u32], depth: usize) -> Option<Vec<usize>> {
        if triangles.len() <= self.leaf_size {
            return None;
        }
        // Splitting by count takes at most 32 levels more.
        if depth + 33 > MOST_DEPTH {
            return Some(by_count(triangles));
        }
        Some(self.partition.split(triangles))
    }
}

/// The lengths of as many equal parts as a node may have children.
pub(super) fn by_count(triangles: &[u32]) -> Vec<usize> {
    let chunk = triangles.len().div_ceil(LANES);
    triangles.chunks(chunk).map(<[u32]>::len).collect()
}

/// Splits as recorded in a layout, whose triangles are in order already.
pub(super) struct Recorded<'a> {
    rest: &'a [u32],
}

impl<'a> Recorded<'a> {
    pub(super) fn new(nodes: &'a [u32]) -> Self {
        Self { rest: nodes }
    }
}

impl Splits for Recorded<'_> {
    fn split(&mut self, _: &mut [u32], _: usize) -> Option<Vec<usize>> {
        let (&children, rest) = self.rest.split_first()?;
        let (counts, rest) = rest.split_at_checked(children as usize)?;
        self.rest = rest;
        (children > 0).then(|| counts.iter().map(|&count| count as usize).collect())
    }
}

pub(super) fn build(model: Arc<MorphModel>, options: &BuildOptions) -> Result<MorphBvh, BuildError> {
    options.check()?;
    let triangles = (0..model.triangle_count() as u32).collect();
    let splits = ByArea {
        partition: Partition::new(&model, options.leaf_size),
        leaf_size: options.leaf_size,
    };
    Ok(build_over(model, options, triangles, splits))
}

/// Builds with options that were checked, over triangles in any order.
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
    let Builder {
        mut topology, tables, ..
    } = builder;
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
    /// The node over these triangles, which it reorders, and what the node spans.
    fn node(&mut self, triangles: &mut [u32], depth: usize) -> (Child, NodeExtents) {
        self.topology.depth = self.topology.depth.max(depth);
        let Some(counts) = self.splits.split(triangles, depth) else {
            return self.leaf(triangles);
        };
        let group = self.reserve();
        let mut rest = triangles;
        let (mut children, mut extents) = (Vec::with_capacity(counts.len()), Vec::with_capacity(counts.len()));
        for count in counts {
            let (part, others) = rest.split_at_mut(count);
            let (child, spanned) = self.node(part, depth + 1);
            children.push(child);
            extents.push(spanned);
            rest = others;
        }
        self.finish(group, &children, &extents);
        (Child::group(group), NodeExtents::of_children(&extents))
    }

    fn leaf(&mut self, triangles: &[u32]) -> (Child, NodeExtents) {
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| self.model.triangle(t as usize)).collect();
        let leaf = self.topology.push_leaf(&corners);
        let extents = NodeExtents::of_vertices(self.model, self.topology.leaf_vertices(leaf));
        (Child::leaf(leaf.0), extents)
    }

    /// Takes the next place in preorder for a group whose children are not known yet.
    fn reserve(&mut self) -> usize {
        self.topology.groups.push(Group::default());
        self.tables.reserve();
        self.topology.groups.len() - 1
    }

    fn finish(&mut self, group: usize, children: &[Child], extents: &[NodeExtents]) {
        let slot = &mut self.topology.groups[group];
        slot.children[..children.len()].copy_from_slice(children);
        slot.len = children.len() as u8;
        self.tables.fill(group, extents);
    }
}
