//! Building: splits nodes from the top down and measures them from the bottom up, in one recursion.

use std::sync::Arc;

use super::clusters::{Cluster, dominant};
use super::extents::NodeExtents;
use super::sah::Partition;
use super::skin_tables::SkinBuilder;
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
        skin: model.skin().map(|_| {
            let vertices = 0..model.vertex_count() as u32;
            let clusters = vertices.map(|vertex| Cluster::of_vertex(&model, vertex));
            SkinBuilder::new(dominant(Cluster::joined(clusters.collect()).iter()))
        }),
    };
    let above_root = builder.reserve();
    let (root, clusters) = builder.node(&mut triangles, 0);
    builder.finish(above_root, &[root], vec![clusters], true);
    let (mut topology, mut tables, skin) = (builder.topology, builder.tables, builder.skin);
    tables.finish();
    topology.triangles = triangles;
    MorphBvh {
        // Vertices that joints move are blended one by one.
        leaf_lanes: (skin.is_none())
            .then(|| LeafLanes::new(&model, &topology).map(Arc::new))
            .flatten(),
        skin: skin.map(|skin| Arc::new(skin.finish(&model))),
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
    skin: Option<SkinBuilder>,
}

impl<S: Splits> Builder<'_, S> {
    /// Builds the node over `triangles`, which it reorders. Returns it with the clusters of its vertices.
    fn node(&mut self, triangles: &mut [u32], depth: usize) -> (Child, Vec<Cluster>) {
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
        let (children, clusters): (Vec<_>, Vec<_>) = counts.into_iter().map(build_child).unzip();
        (Child::group(group), self.finish(group, &children, clusters, depth == 0))
    }

    fn leaf(&mut self, triangles: &[u32]) -> (Child, Vec<Cluster>) {
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&triangle| self.model.corners(triangle)).collect();
        let leaf = self.topology.push_leaf(&corners);
        let vertices = self.topology.leaf_vertices(leaf).iter();
        let clusters = vertices.map(|&vertex| Cluster::of_vertex(self.model, vertex));
        (Child::leaf(leaf), Cluster::joined(clusters.collect()))
    }

    /// Takes the next number in preorder for a group whose children are not known yet.
    fn reserve(&mut self) -> usize {
        self.topology.groups.push(Group::default());
        match &mut self.skin {
            Some(skin) => skin.reserve(),
            None => self.tables.reserve(),
        }
        self.topology.groups.len() - 1
    }

    /// Stores the children of a group and returns the clusters of all of them.
    fn finish(&mut self, group: usize, children: &[Child], clusters: Vec<Vec<Cluster>>, is_top: bool) -> Vec<Cluster> {
        self.topology.groups[group].set(children);
        if let Some(skin) = &mut self.skin {
            // The root's box is the hull of its children's, which make the body's bounds.
            if group > 0 {
                skin.fill(group, &clusters, is_top);
            }
            return Cluster::joined(clusters.into_iter().flatten().collect());
        }
        // Without joints each child is one cluster.
        let extents: Vec<NodeExtents> = clusters.into_iter().flatten().map(|cluster| cluster.extents).collect();
        let whole = NodeExtents::of_parts(extents.iter());
        self.tables.fill(group, &extents, &whole);
        vec![Cluster::without_joints(whole)]
    }
}
