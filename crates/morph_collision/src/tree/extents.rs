//! What a node's vertices span, in `f64`: at the base, with each target at weight 1, and the displacements themselves.

use glam::{DVec3, Vec3};

use crate::bounds::{Aabb, down, up};
use crate::model::MorphModel;

/// What points span along each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    min: DVec3,
    max: DVec3,
}

impl Extent {
    const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };
    const ZERO: Self = Self {
        min: DVec3::ZERO,
        max: DVec3::ZERO,
    };

    fn of(points: impl Iterator<Item = DVec3>) -> Self {
        points.fold(Self::EMPTY, |extent, p| extent.union(&Self { min: p, max: p }))
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The box around the points, rounded outward.
    pub(super) fn outward(&self) -> Aabb {
        Aabb {
            min: Vec3::from_array(self.min.to_array().map(down)),
            max: Vec3::from_array(self.max.to_array().map(up)),
        }
    }

    /// How far the ends of a base box must move to reach these, rounded outward. Covers the roundings of points that are
    /// sums of two vectors.
    pub(super) fn slope_from(&self, base: &Aabb) -> Aabb {
        let reach = self.min.abs().max(self.max.abs()).max_element();
        let pad = 8.0 * f64::EPSILON * reach + 4.0 * f64::EPSILON * base.magnitude().as_dvec3();
        let (low, high) = (
            self.min - base.min.as_dvec3() - pad,
            self.max - base.max.as_dvec3() + pad,
        );
        Self { min: low, max: high }.outward()
    }
}

/// A target that moves some vertex of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct TargetExtents {
    pub(super) target: u32,
    /// The largest absolute displacement.
    pub(super) reach: f32,
    /// Of `d_k`: the interval of displacements.
    pub(super) displacement: Extent,
    /// Of `b + d_k`: the paper's reference volume.
    pub(super) reference: Extent,
}

/// Everything that a node's boxes are made from; `targets` ascending.
#[derive(Clone, Debug)]
pub(super) struct NodeExtents {
    pub(super) base: Extent,
    /// The largest absolute base coordinate.
    pub(super) base_reach: f32,
    pub(super) targets: Vec<TargetExtents>,
}

impl NodeExtents {
    /// Of a leaf's vertices.
    pub(super) fn of_vertices(model: &MorphModel, vertices: &[u32]) -> Self {
        let base = |vertex: u32| model.base(vertex).as_dvec3();
        let targets = moving(model, vertices).into_iter().map(|target| {
            let displacement = |vertex: u32| displacement(model, vertex, target);
            let reach = |reach: f64, &vertex: &u32| displacement(vertex).abs().max_element().max(reach);
            TargetExtents {
                target,
                reach: up(vertices.iter().fold(0.0, reach)),
                displacement: Extent::of(vertices.iter().map(|&v| displacement(v))),
                reference: Extent::of(vertices.iter().map(|&v| base(v) + displacement(v))),
            }
        });
        Self {
            base: Extent::of(vertices.iter().map(|&v| base(v))),
            base_reach: vertices
                .iter()
                .fold(0.0, |reach, &v| model.base(v).abs().max_element().max(reach)),
            targets: targets.collect(),
        }
    }

    /// Of a node from its children. A child that a target leaves alone is at its base under that target.
    pub(super) fn of_children(children: &[Self]) -> Self {
        let all = |of: &dyn Fn(&Self) -> Extent| {
            children
                .iter()
                .fold(Extent::EMPTY, |extent, child| extent.union(&of(child)))
        };
        let targets = local_targets(children).into_iter().map(|target| TargetExtents {
            target,
            reach: reach_under(children, target),
            displacement: all(&|child| child.under(target).map_or(Extent::ZERO, |t| t.displacement)),
            reference: all(&|child| child.under(target).map_or(child.base, |t| t.reference)),
        });
        Self {
            base: all(&|child| child.base),
            base_reach: children.iter().fold(0.0, |reach, c| reach.max(c.base_reach)),
            targets: targets.collect(),
        }
    }

    /// What the node spans under a target that moves it, `None` under one that does not.
    pub(super) fn under(&self, target: u32) -> Option<&TargetExtents> {
        let i = self.targets.binary_search_by_key(&target, |t| t.target).ok()?;
        Some(&self.targets[i])
    }
}

/// The targets that move any of the nodes, ascending.
pub(super) fn local_targets(nodes: &[NodeExtents]) -> Vec<u32> {
    let mut targets: Vec<u32> = nodes.iter().flat_map(|n| n.targets.iter().map(|t| t.target)).collect();
    targets.sort_unstable();
    targets.dedup();
    targets
}

/// The largest absolute displacement of a target in the nodes.
pub(super) fn reach_under(nodes: &[NodeExtents], target: u32) -> f32 {
    let under = nodes.iter().filter_map(|node| node.under(target));
    under.fold(0.0, |reach, t| reach.max(t.reach))
}

/// The targets that move any of the vertices, ascending.
fn moving(model: &MorphModel, vertices: &[u32]) -> Vec<u32> {
    let moving = vertices.iter().flat_map(|&vertex| model.displacements(vertex));
    let mut targets: Vec<u32> = moving.map(|displacement| displacement.target).collect();
    targets.sort_unstable();
    targets.dedup();
    targets
}

fn displacement(model: &MorphModel, vertex: u32, target: u32) -> DVec3 {
    let displacements = model.displacements(vertex);
    match displacements.binary_search_by_key(&target, |d| d.target) {
        Ok(i) => displacements[i].delta.as_dvec3(),
        Err(_) => DVec3::ZERO,
    }
}
