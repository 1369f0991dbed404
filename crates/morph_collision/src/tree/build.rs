//! Top-down topology, bottom-up extents, in one recursion.

use std::sync::Arc;

use super::bvh::{Child, Group};
use super::extents::NodeExtents;
use super::partition::Partition;
use super::{BuildError, BuildOptions, MorphBvh, Tables};
use crate::model::MorphModel;

pub(super) fn build(model: Arc<MorphModel>, options: &BuildOptions) -> Result<MorphBvh, BuildError> {
    if !(1..=255).contains(&options.leaf_size) {
        return Err(BuildError::LeafSize(options.leaf_size));
    }
    let mut triangles: Vec<u32> = (0..model.triangle_count() as u32).collect();
    let mut builder = Builder {
        model: &model,
        leaf_size: options.leaf_size,
        partition: Partition::on_base(&model),
        groups: Vec::new(),
        tables: Tables::default(),
        leaf_starts: vec![0],
        depth: 0,
    };
    let above_root = builder.reserve();
    let (root, extents) = builder.node(&mut triangles, 0);
    builder.finish(above_root, &[root], &[extents]);

    let Builder {
        groups,
        tables,
        leaf_starts,
        depth,
        ..
    } = builder;
    Ok(MorphBvh {
        model,
        groups,
        tables,
        leaf_starts,
        triangles,
        depth,
    })
}

struct Builder<'a> {
    model: &'a MorphModel,
    leaf_size: usize,
    partition: Partition,
    groups: Vec<Group>,
    tables: Tables,
    leaf_starts: Vec<u32>,
    depth: usize,
}

impl Builder<'_> {
    /// The node over these triangles, which it reorders, and what the node spans.
    fn node(&mut self, triangles: &mut [u32], depth: usize) -> (Child, NodeExtents) {
        self.depth = self.depth.max(depth);
        if triangles.len() <= self.leaf_size {
            return self.leaf(triangles);
        }
        let group = self.reserve();
        let counts = self.partition.split(triangles);
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
        let mut vertices: Vec<u32> = triangles
            .iter()
            .flat_map(|&t| self.model.triangle(t as usize))
            .collect();
        vertices.sort_unstable();
        vertices.dedup();
        let leaf = self.leaf_starts.len() - 1;
        let end = self.leaf_starts[leaf] + triangles.len() as u32;
        self.leaf_starts.push(end);
        (Child::leaf(leaf), NodeExtents::of_vertices(self.model, &vertices))
    }

    /// Takes the next place in preorder for a group whose children are not known yet.
    fn reserve(&mut self) -> usize {
        self.groups.push(Group::default());
        self.tables.reserve();
        self.groups.len() - 1
    }

    fn finish(&mut self, group: usize, children: &[Child], extents: &[NodeExtents]) {
        let slot = &mut self.groups[group];
        slot.children[..children.len()].copy_from_slice(children);
        slot.len = children.len() as u8;
        self.tables.fill(group, extents);
    }
}
