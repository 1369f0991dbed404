//! The extents of a node in `f64`: of its vertices at the base and with each target at weight 1, and of the displacements.

use glam::DVec3;

use crate::bounds::{Aabb, Extent};
use crate::model::MorphModel;

impl Extent {
    /// The largest absolute coordinate.
    pub(super) fn reach(&self) -> f64 {
        self.min.abs().max(self.max.abs()).max_element()
    }

    /// How far the ends of a base box must move to become the ends of this box, rounded outward. The pad covers the rounding of
    /// points computed as the sum of two vectors (docs/numerics.md, "Blended boxes").
    pub(super) fn slope_from(&self, base: &Aabb) -> Aabb {
        let pad = 8.0 * f64::EPSILON * self.reach() + 4.0 * f64::EPSILON * base.magnitude().as_dvec3();
        let min = self.min - base.min.as_dvec3() - pad;
        let max = self.max - base.max.as_dvec3() + pad;
        Self { min, max }.outward()
    }
}

/// The extents of a node under a target that moves it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TargetExtents {
    pub(super) target: u16,
    /// The extent of the displacements `d_k`.
    pub(super) displacement: Extent,
    /// The extent of `b + d_k`: the paper's reference volume.
    pub(super) reference: Extent,
}

impl TargetExtents {
    /// The interval of the displacements, as tables store it.
    pub(super) fn interval(&self) -> Aabb {
        self.displacement.outward().coarse()
    }
}

/// Everything from which a node's box is computed.
#[derive(Clone, Debug)]
pub(super) struct NodeExtents {
    pub(super) base: Extent,
    /// The targets that move the node, ascending.
    pub(super) targets: Vec<TargetExtents>,
}

impl NodeExtents {
    pub(super) fn of_vertex(model: &MorphModel, vertex: u32) -> Self {
        let base = model.base(vertex).as_dvec3();
        let displacements = model.displacements(vertex);
        let targets = displacements.map(|displacement| {
            let delta = displacement.delta.as_dvec3();
            TargetExtents {
                target: displacement.target,
                displacement: Extent::point(delta),
                reference: Extent::point(base + delta),
            }
        });
        Self {
            base: Extent::point(base),
            targets: targets.collect(),
        }
    }

    /// The union of some parts. If a target does not move a part, the part stays at its base under that target.
    pub(super) fn of_parts<'p>(parts: impl Iterator<Item = &'p Self> + Clone) -> Self {
        let union = |of: &dyn Fn(&Self) -> Extent| parts.clone().map(of).fold(Extent::EMPTY, Extent::union);
        let mut targets: Vec<u16> = parts.clone().flat_map(|p| p.targets.iter().map(|t| t.target)).collect();
        targets.sort_unstable();
        targets.dedup();
        let under = |target| TargetExtents {
            target,
            displacement: union(&|part| {
                part.under(target)
                    .map_or(Extent::point(DVec3::ZERO), |t| t.displacement)
            }),
            reference: union(&|part| part.under(target).map_or(part.base, |t| t.reference)),
        };
        Self {
            base: union(&|part| part.base),
            targets: targets.into_iter().map(under).collect(),
        }
    }

    /// A corner of the node's base box, as a point that no target moves.
    pub(super) fn a_point(&self) -> Self {
        Self {
            base: Extent::point(self.base.min),
            targets: Vec::new(),
        }
    }

    /// The extents of the node under a target, or `None` if the target does not move it.
    pub(super) fn under(&self, target: u16) -> Option<&TargetExtents> {
        let i = self.targets.binary_search_by_key(&target, |t| t.target).ok()?;
        Some(&self.targets[i])
    }
}
