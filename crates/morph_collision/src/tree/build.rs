//! Top-down topology, bottom-up extents, in one recursion.

use std::sync::Arc;

use super::extents::NodeExtents;
use super::partition::Partition;
use super::topology::{Child, ChildKind, Group};
use super::{AnyTables, BuildError, BuildOptions, Columns, LeafLanes, MorphBvh, Tables, Topology, VolumeKind};
use crate::bounds::Volume;
use crate::model::MorphModel;

/// Deeper nodes are split by count, so that no mesh makes a tree too deep to recurse into.
pub(super) const MOST_DEPTH: usize = 256;

/// Decides how a node's triangles are shared out among its children.
pub(super) trait Splits {
    /// Reorders a node's triangles child by child and returns the children's lengths, `None` for a leaf.
    fn split(&mut self, triangles: &mut [u32], depth: usize) -> Option<Vec<usize>>;
}

/// Splits by a rule, down to leaves of a size.
struct ByRule<'a> {
    partition: &'a Partition,
    leaf_size: usize,
    arity: usize,
}

impl Splits for ByRule<'_> {
    fn split(&mut self, triangles: &mut [u32], depth: usize) -> Option<Vec<usize>> {
        if triangles.len() <= self.leaf_size {
            return None;
        }
        // Splitting by count takes at most 32 levels more.
        if depth + 33 > MOST_DEPTH {
            let chunk = triangles.len().div_ceil(self.arity);
            return Some(triangles.chunks(chunk).map(<[u32]>::len).collect());
        }
        Some(self.partition.split(triangles))
    }
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
    options.check(model.target_count())?;
    let partition = Partition::new(&model, options);
    let triangles = (0..model.triangle_count() as u32).collect();
    let splits = ByRule {
        partition: &partition,
        leaf_size: options.leaf_size,
        arity: options.arity,
    };
    Ok(build_over(model, options, triangles, splits))
}

/// Builds with options that were checked, over triangles in any order.
pub(super) fn build_over(
    model: Arc<MorphModel>,
    options: &BuildOptions,
    triangles: Vec<u32>,
    splits: impl Splits,
) -> MorphBvh {
    let columns = columns_of(&model, options);
    let make = Make {
        model: &model,
        options,
        columns: &columns,
    };
    let (topology, tables) = match options.volume {
        VolumeKind::Aabb => make.tree(triangles, splits, AnyTables::Aabb),
        VolumeKind::Kdop14 => make.tree(triangles, splits, AnyTables::Kdop14),
        VolumeKind::Kdop18 => make.tree(triangles, splits, AnyTables::Kdop18),
        VolumeKind::Kdop26 => make.tree(triangles, splits, AnyTables::Kdop26),
        VolumeKind::Sphere => make.tree(triangles, splits, AnyTables::Sphere),
    };
    MorphBvh {
        leaf_lanes: LeafLanes::new(&model, &topology).map(Arc::new),
        model,
        topology: Arc::new(topology),
        columns,
        tables,
        options: options.clone(),
    }
}

fn columns_of(model: &MorphModel, options: &BuildOptions) -> Columns {
    let targets = model.target_count() as u32;
    let mut scales = options.scales.clone();
    let mut between = Vec::new();
    if options.in_betweens {
        // Half way from the base to a target is the target at scale 1/2, half way between two is a target of its own.
        scales.push(0.5);
        between.extend((1..targets).map(|k| [k - 1, k]));
    }
    scales.sort_by(|a, b| b.total_cmp(a));
    scales.dedup();
    Columns {
        model_targets: targets,
        between,
        scales,
        reflected: options.reflected,
    }
}

/// What a tree is made over.
#[derive(Clone, Copy)]
struct Make<'a> {
    model: &'a MorphModel,
    options: &'a BuildOptions,
    columns: &'a Columns,
}

impl Make<'_> {
    fn tree<V: Volume>(
        self,
        mut triangles: Vec<u32>,
        splits: impl Splits,
        any: impl FnOnce(Arc<Tables<V>>) -> AnyTables,
    ) -> (Topology, AnyTables) {
        let mut builder = Builder {
            make: self,
            splits,
            topology: Topology::new(),
            tables: Tables::<V>::new(self.options.compact),
        };
        let above_root = builder.reserve();
        let (root, extents) = builder.node(&mut triangles, 0);
        builder.finish(above_root, &[root], &[extents]);
        let Builder {
            mut topology, tables, ..
        } = builder;
        topology.triangles = triangles;
        (topology, any(Arc::new(tables)))
    }
}

struct Builder<'a, V: Volume, S> {
    make: Make<'a>,
    splits: S,
    topology: Topology,
    tables: Tables<V>,
}

impl<V: Volume, S: Splits> Builder<'_, V, S> {
    /// The node over these triangles, which it reorders, and what the node spans.
    fn node(&mut self, triangles: &mut [u32], depth: usize) -> (Child, NodeExtents<V>) {
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
        (
            Child::group(group),
            NodeExtents::of_children(self.make.columns, &extents),
        )
    }

    fn leaf(&mut self, triangles: &[u32]) -> (Child, NodeExtents<V>) {
        let Make { model, columns, .. } = self.make;
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| model.triangle(t as usize)).collect();
        let leaf = self.topology.push_leaf(&corners);
        let vertices = self.topology.leaf_vertices(leaf).to_vec();
        (Child::leaf(leaf.0), NodeExtents::of_vertices(model, columns, vertices))
    }

    /// Takes the next place in preorder for a group whose children are not known yet.
    fn reserve(&mut self) -> usize {
        self.topology.groups.push(Group::default());
        self.tables.reserve();
        self.topology.groups.len() - 1
    }

    fn finish(&mut self, group: usize, children: &[Child], extents: &[NodeExtents<V>]) {
        let slot = &mut self.topology.groups[group];
        slot.children[..children.len()].copy_from_slice(children);
        slot.len = children.len() as u8;
        let has_table = |child: &Child| self.make.options.leaf_tables || matches!(child.kind(), ChildKind::Group(_));
        let lanes = children
            .iter()
            .enumerate()
            .map(|(lane, child)| u8::from(has_table(child)) << lane)
            .sum();
        self.tables
            .fill(group, self.make.model, self.make.columns, extents, lanes);
    }
}
