//! What a node's vertices span: at the base, at each scaled reference, and the displacements themselves.

use glam::DVec3;

use super::columns::{Columns, Shape};
use crate::bounds::Volume;
use crate::model::MorphModel;

/// A target that moves some vertex of a node.
#[derive(Clone, Debug)]
pub(super) struct TargetExtents<V: Volume> {
    pub(super) target: u32,
    /// The largest absolute displacement.
    pub(super) reach: f32,
    /// Of `d_k`: the interval of displacements.
    pub(super) displacement: V::Extent,
    /// Of `b + S d_k` for each signed scale `S`: the paper's reference volume for `S = 1`.
    pub(super) references: Vec<V::Extent>,
}

/// Everything a node's volumes are made from; `targets` ascending.
#[derive(Clone, Debug)]
pub(super) struct NodeExtents<V: Volume> {
    pub(super) base: V::Extent,
    /// The largest absolute base coordinate.
    pub(super) base_reach: f32,
    pub(super) targets: Vec<TargetExtents<V>>,
    /// The node's vertices, if the kind of volume looks at them or the node is a leaf.
    pub(super) vertices: Vec<u32>,
}

impl<V: Volume> NodeExtents<V> {
    /// Of a leaf's vertices.
    pub(super) fn of_vertices(model: &MorphModel, columns: &Columns, vertices: Vec<u32>) -> Self {
        let mut node = Self {
            base: V::extent(&|_| {}),
            base_reach: 0.0,
            targets: Vec::new(),
            vertices,
        };
        let of = |shape: Shape| V::extent(&|each| columns.for_each_point(model, &node.vertices, shape, each));
        let base = of(Shape::Base);
        let targets = columns
            .local_targets(model, &node.vertices)
            .into_iter()
            .map(|target| TargetExtents {
                target,
                reach: columns.reach(model, &node.vertices, target),
                displacement: of(Shape::Displacement(target)),
                references: columns
                    .scales()
                    .map(|scale| of(Shape::Reference(target, scale)))
                    .collect(),
            })
            .collect();
        node.base_reach = node
            .vertices
            .iter()
            .fold(0.0, |reach, &v| model.base(v).abs().max_element().max(reach));
        node.base = base;
        node.targets = targets;
        node
    }

    /// Of a node from its children. A child that a target leaves alone is at its base under that target.
    pub(super) fn of_children(columns: &Columns, children: &[Self]) -> Self {
        let still = V::extent(&|each| each(DVec3::ZERO));
        let all = |of: &dyn Fn(&Self) -> V::Extent| {
            let extents = children.iter().map(of);
            extents.reduce(|a, b| V::union(&a, &b)).unwrap_or_else(|| still.clone())
        };
        let targets = local_targets(children)
            .into_iter()
            .map(|target| TargetExtents {
                target,
                reach: children
                    .iter()
                    .filter_map(|c| c.under(target))
                    .fold(0.0, |reach, t| reach.max(t.reach)),
                displacement: all(&|child| {
                    child
                        .under(target)
                        .map_or_else(|| still.clone(), |t| t.displacement.clone())
                }),
                references: (0..columns.scales().len())
                    .map(|s| all(&|child| child.under(target).map_or(&child.base, |t| &t.references[s]).clone()))
                    .collect(),
            })
            .collect();
        let vertices = if V::LOOKS_AT_POINTS {
            let mut vertices: Vec<u32> = children.iter().flat_map(|c| &c.vertices).copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
            vertices
        } else {
            Vec::new()
        };
        Self {
            base: all(&|child| child.base.clone()),
            base_reach: children.iter().fold(0.0, |reach, c| reach.max(c.base_reach)),
            targets,
            vertices,
        }
    }

    /// What the node spans under a target that moves it, `None` under one that does not.
    pub(super) fn under(&self, target: u32) -> Option<&TargetExtents<V>> {
        let i = self.targets.binary_search_by_key(&target, |t| t.target).ok()?;
        Some(&self.targets[i])
    }
}

/// The targets that move any of the nodes, ascending.
pub(super) fn local_targets<V: Volume>(nodes: &[NodeExtents<V>]) -> Vec<u32> {
    let mut targets: Vec<u32> = nodes.iter().flat_map(|n| n.targets.iter().map(|t| t.target)).collect();
    targets.sort_unstable();
    targets.dedup();
    targets
}
