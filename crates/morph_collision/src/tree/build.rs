//! Top-down topology, bottom-up extents, in one recursion.

use std::sync::Arc;

use super::extents::NodeExtents;
use super::partition::Partition;
use super::topology::{Child, ChildKind, Group};
use super::{AnyTables, BuildError, BuildOptions, Columns, MorphBvh, Tables, Topology, VolumeKind};
use crate::bounds::Volume;
use crate::model::MorphModel;

pub(super) fn build(model: Arc<MorphModel>, options: &BuildOptions) -> Result<MorphBvh, BuildError> {
    options.check(model.target_count())?;
    let columns = columns_of(&model, options);
    let partition = Partition::new(&model, options);
    let (topology, tables) = match options.volume {
        VolumeKind::Aabb => split(&model, options, &columns, &partition, AnyTables::Aabb),
        VolumeKind::Kdop14 => split(&model, options, &columns, &partition, AnyTables::Kdop14),
        VolumeKind::Kdop18 => split(&model, options, &columns, &partition, AnyTables::Kdop18),
        VolumeKind::Kdop26 => split(&model, options, &columns, &partition, AnyTables::Kdop26),
        VolumeKind::Sphere => split(&model, options, &columns, &partition, AnyTables::Sphere),
    };
    Ok(MorphBvh {
        model,
        topology: Arc::new(topology),
        columns,
        tables,
        options: options.clone(),
    })
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

fn split<V: Volume>(
    model: &MorphModel,
    options: &BuildOptions,
    columns: &Columns,
    partition: &Partition,
    any: impl FnOnce(Arc<Tables<V>>) -> AnyTables,
) -> (Topology, AnyTables) {
    let mut triangles: Vec<u32> = (0..model.triangle_count() as u32).collect();
    let mut builder = Builder {
        model,
        options,
        columns,
        partition,
        topology: Topology {
            groups: Vec::new(),
            leaf_starts: vec![0],
            triangles: Vec::new(),
            depth: 0,
        },
        tables: Tables::<V>::new(),
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

struct Builder<'a, V: Volume> {
    model: &'a MorphModel,
    options: &'a BuildOptions,
    columns: &'a Columns,
    partition: &'a Partition,
    topology: Topology,
    tables: Tables<V>,
}

impl<V: Volume> Builder<'_, V> {
    /// The node over these triangles, which it reorders, and what the node spans.
    fn node(&mut self, triangles: &mut [u32], depth: usize) -> (Child, NodeExtents<V>) {
        self.topology.depth = self.topology.depth.max(depth);
        if triangles.len() <= self.options.leaf_size {
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
        (Child::group(group), NodeExtents::of_children(self.columns, &extents))
    }

    fn leaf(&mut self, triangles: &[u32]) -> (Child, NodeExtents<V>) {
        let mut vertices: Vec<u32> = triangles
            .iter()
            .flat_map(|&t| self.model.triangle(t as usize))
            .collect();
        vertices.sort_unstable();
        vertices.dedup();
        let starts = &mut self.topology.leaf_starts;
        let leaf = starts.len() - 1;
        starts.push(starts[leaf] + triangles.len() as u32);
        (
            Child::leaf(leaf),
            NodeExtents::of_vertices(self.model, self.columns, vertices),
        )
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
        let has_table = |child: &Child| self.options.leaf_tables || matches!(child.kind(), ChildKind::Group(_));
        let lanes = children
            .iter()
            .enumerate()
            .map(|(lane, child)| u8::from(has_table(child)) << lane)
            .sum();
        self.tables.fill(group, self.model, self.columns, extents, lanes);
    }
}
