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

    /// The union of some parts.
    pub(super) fn of_parts<'p>(mut parts: impl Iterator<Item = &'p Self>) -> Self {
        let none = Self {
            base: Extent::EMPTY,
            targets: Vec::new(),
        };
        let mut union = parts.next().cloned().unwrap_or(none);
        parts.for_each(|part| union.add(part));
        union
    }

    /// Adds a part. If a target does not move a part, the part stays at its base under that target.
    pub(super) fn add(&mut self, part: &Self) {
        let before = self.base;
        self.base = before.union(part.base);
        let mut own = self.targets.iter().peekable();
        let is_known = |of_part: &TargetExtents| {
            while own.next_if(|own| own.target < of_part.target).is_some() {}
            own.next_if(|own| own.target == of_part.target).is_some()
        };
        if !part.targets.iter().all(is_known) {
            self.insert(part, before);
        }
        let mut of_part = part.targets.iter().peekable();
        for own in &mut self.targets {
            let (displacement, reference) = match of_part.next_if(|of_part| of_part.target == own.target) {
                Some(of_part) => (of_part.displacement, of_part.reference),
                None => (Extent::point(DVec3::ZERO), part.base),
            };
            own.displacement = own.displacement.union(displacement);
            own.reference = own.reference.union(reference);
        }
    }

    /// Adds itself to a union of parts, of which it may be the first.
    pub(super) fn add_to(&self, union: &mut Option<Self>) {
        match union {
            Some(union) => union.add(self),
            None => *union = Some(self.clone()),
        }
    }

    /// Inserts the targets of another part that do not move this one, whose base is `base`.
    fn insert(&mut self, other: &Self, base: Extent) {
        let mut all = Vec::with_capacity(self.targets.len() + other.targets.len());
        let mut own = self.targets.iter().peekable();
        for &TargetExtents { target, .. } in &other.targets {
            while let Some(own) = own.next_if(|own| own.target < target) {
                all.push(*own);
            }
            let still = TargetExtents {
                target,
                displacement: Extent::point(DVec3::ZERO),
                reference: base,
            };
            all.push(*own.next_if(|own| own.target == target).unwrap_or(&still));
        }
        all.extend(own);
        self.targets = all;
    }

    /// The extents of the node under a target, or `None` if the target does not move it.
    pub(super) fn under(&self, target: u16) -> Option<&TargetExtents> {
        let i = self.targets.binary_search_by_key(&target, |t| t.target).ok()?;
        Some(&self.targets[i])
    }
}
