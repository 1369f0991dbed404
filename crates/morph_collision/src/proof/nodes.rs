//! Bounds on the gap between two nodes of a tree, for all weights in a box.

use glam::DVec3;

use super::rounding::{least, vertex_error};
use crate::bounds::Extent;
use crate::model::{MorphModel, WeightBox};
use crate::tree::{Child, ChildKind, NodeId, Topology};

/// A node: its box at the base, and boxes around the displacements of the targets that move it.
#[derive(Clone, Debug)]
pub(super) struct NodeMotion {
    base: Extent,
    /// Ascending by target.
    targets: Vec<(u16, Extent)>,
    /// A bound on the rounding of its posed vertices.
    error: f64,
    pub(super) triangles: u64,
}

/// The motions of all nodes of a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeMotions {
    /// By group and lane, in the order of the groups.
    groups: Vec<Vec<NodeMotion>>,
}

impl NodeMotions {
    /// Bottom up: groups are in preorder, so children come after their parents.
    pub(super) fn new(model: &MorphModel, topology: &Topology, weights: &WeightBox) -> Self {
        let mut groups: Vec<Vec<NodeMotion>> = vec![Vec::new(); topology.group_count()];
        for group in (0..topology.group_count()).rev() {
            let motion = |child: &Child| match child.kind() {
                ChildKind::Leaf(leaf) => {
                    let vertices = topology.leaf_vertices(leaf).iter();
                    let mut parts = vertices.map(|&vertex| NodeMotion::of_vertex(model, vertex));
                    let first = parts.next().unwrap_or_else(NodeMotion::empty);
                    let mut motion = parts.fold(first, |whole, part| whole.union(&part));
                    motion.triangles = topology.leaf_triangles(leaf).len() as u64;
                    motion
                }
                ChildKind::Group(below) => {
                    let (first, others) = groups[below]
                        .split_first()
                        .map_or((None, &[][..]), |(a, b)| (Some(a), b));
                    let first = first.cloned().unwrap_or_else(NodeMotion::empty);
                    others.iter().fold(first, |whole, part| whole.union(part))
                }
            };
            groups[group] = topology.group(group).children().iter().map(motion).collect();
        }
        for node in groups.iter_mut().flatten() {
            node.set_error(weights);
        }
        Self { groups }
    }

    pub(super) fn get(&self, node: NodeId) -> &NodeMotion {
        &self.groups[node.group as usize][usize::from(node.lane)]
    }

    /// Whether no vertices of two nodes' triangles, nor anything between them, can meet for any weights in the box.
    pub(super) fn are_apart(&self, a: NodeId, b: NodeId, weights: &WeightBox) -> bool {
        let (a, b) = (self.get(a), self.get(b));
        let between = b.centre() - a.centre();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * if axis.dot(between) < 0.0 { -1.0 } else { 1.0 });
        // The axis along which the centres are farthest apart first.
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| between[j].abs().total_cmp(&between[i].abs()));
        let directions = order
            .into_iter()
            .map(|axis| axes[axis])
            .chain([between.normalize_or_zero()]);
        directions
            .into_iter()
            .any(|direction| a.gap(b, direction, weights) > 0.0)
    }
}

impl NodeMotion {
    fn empty() -> Self {
        Self {
            base: Extent::EMPTY,
            targets: Vec::new(),
            error: 0.0,
            triangles: 0,
        }
    }

    fn of_vertex(model: &MorphModel, vertex: u32) -> Self {
        let displacements = model.displacements(vertex);
        Self {
            base: Extent::point(model.base(vertex).as_dvec3()),
            targets: displacements
                .map(|d| (d.target, Extent::point(d.delta.as_dvec3())))
                .collect(),
            ..Self::empty()
        }
    }

    /// A target that does not move a node displaces its vertices by zero.
    fn union(&self, other: &Self) -> Self {
        let mut targets = Vec::with_capacity(self.targets.len().max(other.targets.len()));
        visit_both(&self.targets, &other.targets, |target, a, b| {
            targets.push((target, a.union(*b)));
        });
        Self {
            base: self.base.union(other.base),
            targets,
            error: 0.0,
            triangles: self.triangles + other.triangles,
        }
    }

    fn set_error(&mut self, weights: &WeightBox) {
        let magnitude = |extent: &Extent| extent.min.abs().max(extent.max.abs()).max_element();
        let moved = self
            .targets
            .iter()
            .map(|(target, extent)| weights.reach(*target) * magnitude(extent));
        let reach = magnitude(&self.base) + moved.sum::<f64>();
        self.error = vertex_error(self.targets.len(), reach);
    }

    fn centre(&self) -> DVec3 {
        (self.base.min + self.base.max) * 0.5
    }

    /// A lower bound on the gap along a direction from here to another node, rounding taken off.
    fn gap(&self, other: &Self, direction: DVec3, weights: &WeightBox) -> f64 {
        let mut gap = lowest(&other.base, direction) - highest(&self.base, direction);
        visit_both(&self.targets, &other.targets, |target, a, b| {
            let above = lowest(b, direction) - highest(a, direction);
            let below = highest(b, direction) - lowest(a, direction);
            gap += least(weights.of(target), above, below);
        });
        gap - direction.abs().element_sum() * (self.error + other.error)
    }
}

const STILL: Extent = Extent {
    min: DVec3::ZERO,
    max: DVec3::ZERO,
};

/// Visits the targets of two ascending lists, with what each list has for them.
fn visit_both(a: &[(u16, Extent)], b: &[(u16, Extent)], mut visit: impl FnMut(u16, &Extent, &Extent)) {
    let (mut i, mut j) = (0, 0);
    loop {
        match (a.get(i), b.get(j)) {
            (Some((s, of_a)), Some((t, of_b))) if s == t => {
                visit(*s, of_a, of_b);
                (i, j) = (i + 1, j + 1);
            }
            (Some((s, of_a)), of_b) if of_b.is_none_or(|(t, _)| s < t) => {
                visit(*s, of_a, &STILL);
                i += 1;
            }
            (_, Some((t, of_b))) => {
                visit(*t, &STILL, of_b);
                j += 1;
            }
            _ => return,
        }
    }
}

/// The smallest value of `direction . x` over a box.
fn lowest(extent: &Extent, direction: DVec3) -> f64 {
    (extent.min * direction).min(extent.max * direction).element_sum()
}

fn highest(extent: &Extent, direction: DVec3) -> f64 {
    (extent.min * direction).max(extent.max * direction).element_sum()
}
