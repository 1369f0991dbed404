//! Building: splits nodes top-down and measures them bottom-up, in one pass.

use std::sync::Arc;
use std::vec;

use super::budget::{Budget, run_to_end};
use super::clusters::{Cluster, Shares};
use super::extents::NodeExtents;
use super::sah::Partition;
use super::skin_tables::SkinBuilder;
use super::topology::{Child, Group};
use super::{BuildOptions, LeafLanes, MorphBvh, Tables, Topology};
use crate::bounds::{Kernel, LANES};
use crate::model::{MorphModel, Skin};

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
        skin: match model.skin() {
            Some(skin) => Some(SkinBuilder::new(dominant_joint(&model, skin, budget).await, skin)),
            None => None,
        },
    };
    let above_root = builder.reserve();
    let (root, clusters) = builder.nodes(&mut triangles).await;
    builder.finish(above_root, &[root], vec![clusters], true);
    let Builder {
        mut topology,
        mut tables,
        skin,
        splits,
        ..
    } = builder;
    // It takes as much memory as all that follows.
    drop(splits);
    tables.finish();
    topology.shrink_to_fit();
    topology.triangles = triangles;
    let leaf_lanes = match skin {
        // Vertices moved by joints are blended one by one.
        Some(_) => None,
        None => LeafLanes::new(&model, &topology, budget).await.map(Arc::new),
    };
    budget
        .spend(if skin.is_some() { model.vertex_count() } else { 0 })
        .await;
    MorphBvh {
        leaf_lanes,
        skin: skin.map(|skin| Arc::new(skin.finish(&model, &topology))),
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

/// The joint that moves most of the mesh.
async fn dominant_joint(model: &MorphModel, skin: &Skin, budget: &Budget) -> u16 {
    let mut shares = Shares::default();
    for vertex in 0..model.vertex_count() as u32 {
        budget.spend(WORK_ON_JOINTS).await;
        shares.add(skin, vertex);
    }
    shares.dominant()
}

/// The work on the joints of a vertex.
const WORK_ON_JOINTS: usize = 4;

/// The work of measuring `count` vertices or children on every target.
fn work_on(model: &MorphModel, count: usize) -> usize {
    // Joints are not counted, because a vertex has few.
    count * (WORK_ON_JOINTS + model.target_count())
}

struct Builder<'a, S> {
    model: &'a MorphModel,
    budget: &'a Budget,
    splits: S,
    topology: Topology,
    tables: Tables,
    skin: Option<SkinBuilder>,
}

/// A group whose children are being built.
struct Open {
    group: usize,
    /// The numbers of triangles of the remaining children.
    counts: vec::IntoIter<usize>,
    children: Vec<Child>,
    clusters: Vec<Vec<Cluster>>,
}

impl<S: Splits> Builder<'_, S> {
    /// Builds all nodes in preorder and reorders `triangles` accordingly. Returns the root and the clusters of its vertices.
    async fn nodes(&mut self, triangles: &mut [u32]) -> (Child, Vec<Cluster>) {
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
                    clusters: Vec::with_capacity(children),
                });
            }
            self.topology.depth = self.topology.depth.max(open.len());
            self.budget.spend(work_on(self.model, range.len())).await;
            let mut node = self.leaf(&triangles[range.clone()]);
            // Up again, past all groups whose last child is done.
            loop {
                let Some(mut parent) = open.pop() else { return node };
                let (child, clusters) = node;
                parent.children.push(child);
                parent.clusters.push(clusters);
                if let Some(count) = parent.counts.next() {
                    range = range.end..range.end + count;
                    open.push(parent);
                    break;
                }
                self.budget.spend(work_on(self.model, parent.children.len())).await;
                let clusters = self.finish(parent.group, &parent.children, parent.clusters, open.is_empty());
                node = (Child::group(parent.group), clusters);
            }
        }
    }

    fn leaf(&mut self, triangles: &[u32]) -> (Child, Vec<Cluster>) {
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&triangle| self.model.corners(triangle)).collect();
        let leaf = self.topology.push_leaf(&corners);
        let vertices = self.topology.leaf_vertices(leaf).iter();
        let clusters = vertices.map(|&vertex| Cluster::of_vertex(self.model, vertex));
        (Child::leaf(leaf), Cluster::joined(clusters.collect()))
    }

    /// Reserves the next number in preorder for a group whose children are not known yet.
    fn reserve(&mut self) -> usize {
        self.topology.groups.push(Group::default());
        match &mut self.skin {
            Some(skin) => skin.reserve(),
            None => self.tables.reserve(),
        }
        self.topology.groups.len() - 1
    }

    /// Stores the children of a group and returns their joined clusters.
    fn finish(&mut self, group: usize, children: &[Child], clusters: Vec<Vec<Cluster>>, is_top: bool) -> Vec<Cluster> {
        self.topology.groups[group].set(children);
        if let Some(skin) = &mut self.skin {
            // Group 0 holds only the root, whose box is the hull of its children's boxes.
            if group > 0 {
                skin.fill(group, &clusters, is_top);
            }
            return Cluster::joined(clusters.into_iter().flatten().collect());
        }
        // Without joints, each child is one cluster.
        let extents: Vec<NodeExtents> = clusters.into_iter().flatten().map(|cluster| cluster.extents).collect();
        let whole = NodeExtents::of_parts(extents.iter());
        self.tables.fill(group, &extents, &whole);
        vec![Cluster::without_joints(whole)]
    }
}
