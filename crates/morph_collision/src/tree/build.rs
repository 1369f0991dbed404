//! Building: splits nodes top-down and measures them bottom-up, in one pass.

use std::sync::Arc;
use std::vec;

use super::budget::{Budget, run_to_end, work_on};
use super::extents::NodeExtents;
use super::sah::Partition;
use super::topology::{Child, Group};
use super::{BuildOptions, LeafLanes, MorphBvh, SkinTables, Tables, Topology};
use crate::bounds::{Kernel, LANES};
use crate::model::MorphModel;

/// The maximum depth of a tree. Not measured; trees of real meshes have about ten levels.
pub(super) const MAX_DEPTH: usize = 256;
/// More levels than splitting by count ever takes: each level divides up to 2^31 triangles by eight.
const COUNT_DEPTH: usize = 33;

/// Decides how a node's triangles are divided among its children.
pub(super) trait Splits {
    /// Reorders a node's triangles child by child, and returns the number of triangles of each child. `None` makes the node a leaf.
    async fn split(&mut self, triangles: &mut [u32], depth: usize, budget: &Budget) -> Option<Vec<usize>>;
}

impl Splits for Partition {
    async fn split(&mut self, triangles: &mut [u32], depth: usize, budget: &Budget) -> Option<Vec<usize>> {
        if triangles.len() <= self.leaf_size {
            return None;
        }
        let counts = if depth + COUNT_DEPTH > MAX_DEPTH {
            Vec::new()
        } else {
            self.by_area(triangles, budget).await
        };
        if counts.len() > 1 {
            return Some(counts);
        }
        // No plane separates the midpoints, or the tree is too deep: split by count.
        let chunks = triangles.chunks(triangles.len().div_ceil(LANES));
        Some(chunks.map(<[u32]>::len).collect())
    }
}

/// Replays the splits of a layout, whose triangles are already in order. Holds the nodes still to come.
pub(super) struct Recorded<'a>(pub(super) &'a [u32]);

impl Splits for Recorded<'_> {
    async fn split(&mut self, _: &mut [u32], _: usize, _: &Budget) -> Option<Vec<usize>> {
        let (&children, rest) = self.0.split_first()?;
        let (counts, rest) = rest.split_at_checked(children as usize)?;
        self.0 = rest;
        (children > 0).then(|| counts.iter().map(|&count| count as usize).collect())
    }
}

impl MorphBvh {
    /// Builds the tree. To build it in steps, use [`MorphBvhBuilder`](crate::MorphBvhBuilder).
    ///
    /// Memory while it is built: at most about three times what the tree and the model have afterwards, together with them.
    #[must_use]
    pub fn build(model: Arc<MorphModel>, options: &BuildOptions) -> Self {
        run_to_end(build_within(model, options, &Budget::unlimited()))
    }
}

/// Builds a tree, pausing between the pieces of work.
pub(super) async fn build_within(model: Arc<MorphModel>, options: &BuildOptions, budget: &Budget) -> MorphBvh {
    let triangles = (0..model.triangle_count() as u32).collect();
    let splits = Partition::new(&model, options.leaf_size(), budget).await;
    build_over(model, options, triangles, splits, budget).await
}

/// Builds a tree over all triangles, given in any order.
pub(super) async fn build_over(
    model: Arc<MorphModel>,
    options: &BuildOptions,
    mut triangles: Vec<u32>,
    splits: impl Splits,
    budget: &Budget,
) -> MorphBvh {
    let mut builder = Builder {
        model: &model,
        budget,
        splits,
        topology: Topology::new(),
        tables: Tables::default(),
    };
    let above_root = builder.reserve();
    let (root, extents) = builder.nodes(&mut triangles).await;
    builder.finish(above_root, &[root], vec![extents]);
    let Builder {
        mut topology,
        mut tables,
        splits,
        ..
    } = builder;
    // It takes as much memory as all that follows.
    drop(splits);
    tables.finish();
    topology.shrink_to_fit();
    topology.triangles = triangles;
    let (leaf_lanes, skin) = match model.skin() {
        // Vertices moved by joints are posed in chunks.
        Some(skin) => (None, Some(SkinTables::new(&model, skin, &topology, budget).await)),
        None => (LeafLanes::new(&model, &topology, budget).await, None),
    };
    MorphBvh {
        leaf_lanes: leaf_lanes.map(Arc::new),
        skin: skin.map(Arc::new),
        model,
        topology: Arc::new(topology),
        tables: Arc::new(tables),
        options: *options,
        owners: Arc::default(),
        self_front: Arc::default(),
        certificates: Arc::default(),
        kernel: Kernel::default(),
    }
}

struct Builder<'a, S> {
    model: &'a MorphModel,
    budget: &'a Budget,
    splits: S,
    topology: Topology,
    /// Empty for a skinned mesh.
    tables: Tables,
}

/// A group whose children are being built.
struct Open {
    group: usize,
    /// The numbers of triangles of the remaining children.
    counts: vec::IntoIter<usize>,
    children: Vec<Child>,
    extents: Vec<Option<NodeExtents>>,
}

impl<S: Splits> Builder<'_, S> {
    /// Builds all nodes in preorder and reorders `triangles` accordingly. Returns the root and its extents, without those of a skinned mesh.
    async fn nodes(&mut self, triangles: &mut [u32]) -> (Child, Option<NodeExtents>) {
        let mut open: Vec<Open> = Vec::new();
        let mut range = 0..triangles.len();
        loop {
            // Down to the next leaf.
            while let Some(counts) = self
                .splits
                .split(&mut triangles[range.clone()], open.len(), self.budget)
                .await
            {
                let children = counts.len();
                let mut counts = counts.into_iter();
                range.end = range.start + counts.next().unwrap_or_default();
                open.push(Open {
                    group: self.reserve(),
                    counts,
                    children: Vec::with_capacity(children),
                    extents: Vec::with_capacity(children),
                });
            }
            self.topology.depth = self.topology.depth.max(open.len());
            self.budget.spend(work_on(self.model, range.len())).await;
            let mut node = self.leaf(&triangles[range.clone()]);
            // Up again, past all groups whose last child is done.
            loop {
                let Some(mut parent) = open.pop() else { return node };
                let (child, extents) = node;
                parent.children.push(child);
                parent.extents.push(extents);
                if let Some(count) = parent.counts.next() {
                    range = range.end..range.end + count;
                    open.push(parent);
                    break;
                }
                self.budget.spend(work_on(self.model, parent.children.len())).await;
                let extents = self.finish(parent.group, &parent.children, parent.extents);
                node = (Child::group(parent.group), extents);
            }
        }
    }

    fn leaf(&mut self, triangles: &[u32]) -> (Child, Option<NodeExtents>) {
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&triangle| self.model.corners(triangle)).collect();
        let leaf = self.topology.push_leaf(&corners);
        let of_vertex = |&vertex: &u32| NodeExtents::of_vertex(self.model, vertex);
        let extents = self.model.skin().is_none().then(|| {
            let parts: Vec<NodeExtents> = self.topology.leaf_vertices(leaf).iter().map(of_vertex).collect();
            NodeExtents::of_parts(parts.iter())
        });
        (Child::leaf(leaf), extents)
    }

    /// Reserves the next number in preorder for a group whose children are not known yet.
    fn reserve(&mut self) -> usize {
        self.topology.groups.push(Group::default());
        if self.model.skin().is_none() {
            self.tables.reserve();
        }
        self.topology.groups.len() - 1
    }

    /// Stores the children of a group and returns their union.
    fn finish(&mut self, group: usize, children: &[Child], extents: Vec<Option<NodeExtents>>) -> Option<NodeExtents> {
        self.topology.groups[group].set(children);
        let extents: Vec<NodeExtents> = extents.into_iter().collect::<Option<_>>()?;
        let whole = NodeExtents::of_parts(extents.iter());
        self.tables.fill(group, &extents, &whole);
        Some(whole)
    }
}
