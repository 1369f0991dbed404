//! What a node's vertices span: at the base, displaced by each target, and the displacements themselves.

use glam::{DVec3, Vec3};

use crate::bounds::Aabb;
use crate::model::MorphModel;

/// A box in `f64`; sums of two `f32` are held to a relative 2^-53.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

impl Extent {
    const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    fn add(&mut self, p: DVec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    fn of_box(bounds: &Aabb) -> Self {
        Self {
            min: bounds.min.as_dvec3(),
            max: bounds.max.as_dvec3(),
        }
    }
}

/// A target that moves some vertex of a node.
#[derive(Clone, Debug)]
pub(super) struct TargetExtents {
    pub(super) target: u32,
    /// Of `b + d_k`: the paper's reference volume.
    pub(super) reference: Extent,
    /// Of `d_k`: the interval of displacements.
    pub(super) displacement: Aabb,
}

/// Everything a node's volumes are made from; `targets` ascending.
#[derive(Clone, Debug)]
pub(super) struct NodeExtents {
    pub(super) base: Aabb,
    pub(super) targets: Vec<TargetExtents>,
}

impl NodeExtents {
    /// Of a leaf's vertices, each displacement looked up.
    pub(super) fn of_vertices(model: &MorphModel, vertices: &[u32]) -> Self {
        let base = Aabb::from_points(vertices.iter().map(|&v| model.base(v)));
        let mut locals: Vec<u32> = vertices
            .iter()
            .flat_map(|&v| model.displacements(v).iter().map(|d| d.target))
            .collect();
        locals.sort_unstable();
        locals.dedup();
        let targets = locals
            .into_iter()
            .map(|target| {
                let mut reference = Extent::EMPTY;
                let mut displacement = Aabb::EMPTY;
                for &v in vertices {
                    let delta = displacement_of(model, v, target);
                    reference.add(model.base(v).as_dvec3() + delta.as_dvec3());
                    displacement = displacement.union(&Aabb { min: delta, max: delta });
                }
                TargetExtents {
                    target,
                    reference,
                    displacement,
                }
            })
            .collect();
        Self { base, targets }
    }

    /// Of a node from its children. A child that a target leaves alone is at its base under that target.
    pub(super) fn of_children(children: &[Self]) -> Self {
        let base = children.iter().fold(Aabb::EMPTY, |hull, c| hull.union(&c.base));
        let targets = local_targets(children)
            .into_iter()
            .map(|target| {
                let mut reference = Extent::EMPTY;
                let mut displacement = Aabb::EMPTY;
                for child in children {
                    let (r, d) = child.under(target).unwrap_or_else(|| child.at_rest());
                    reference = reference.union(&r);
                    displacement = displacement.union(&d);
                }
                TargetExtents {
                    target,
                    reference,
                    displacement,
                }
            })
            .collect();
        Self { base, targets }
    }

    /// Reference and displacement extents under a target that moves the node, `None` under one that does not.
    pub(super) fn under(&self, target: u32) -> Option<(Extent, Aabb)> {
        let i = self.targets.binary_search_by_key(&target, |t| t.target).ok()?;
        Some((self.targets[i].reference, self.targets[i].displacement))
    }

    /// The same under a target that leaves the node alone.
    fn at_rest(&self) -> (Extent, Aabb) {
        let still = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ZERO,
        };
        (Extent::of_box(&self.base), still)
    }
}

/// The targets that move any of the nodes, ascending.
pub(super) fn local_targets(nodes: &[NodeExtents]) -> Vec<u32> {
    let mut targets: Vec<u32> = nodes.iter().flat_map(|n| n.targets.iter().map(|t| t.target)).collect();
    targets.sort_unstable();
    targets.dedup();
    targets
}

fn displacement_of(model: &MorphModel, vertex: u32, target: u32) -> Vec3 {
    let displacements = model.displacements(vertex);
    match displacements.binary_search_by_key(&target, |d| d.target) {
        Ok(i) => displacements[i].delta,
        Err(_) => Vec3::ZERO,
    }
}
