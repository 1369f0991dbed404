//! What a pose blends: per group of children the base boxes and, per local target, two slopes for each end of each box.
//!
//! With `s` an end of a child's base box and `w_k` the weights, the posed end is bounded by
//! `s + sum_k a_k X_k(1) + sum_k r_k X_k(inf)` where `a_k + r_k = w_k`, `a_k >= 0` and `sum_k a_k <= 1`: the *budget*.
//! `X_k(1)` moves the end to the reference's, which is the paper's blending (Eq. 3); `X_k(inf)` moves it by the extreme
//! displacement, which is interval arithmetic and holds for any weights. Every slope is rounded outward.

use std::ops::Range;

use glam::{DVec3, Vec3};

use super::extents::{Extent, NodeExtents, local_targets};
use crate::bounds::{Aabb, BoxLanes};

/// A target that moves some child of a group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalTarget {
    pub(crate) target: u32,
    /// The largest absolute displacement in the group.
    pub(crate) reach: f32,
}

/// Slopes of a local target for eight children.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slopes {
    /// `X(1)` of both ends: for weights within the budget.
    pub(crate) reference: BoxLanes,
    /// `X(inf)` of both ends: for weights beyond the budget, and with the ends swapped for negative ones.
    pub(crate) interval: BoxLanes,
}

/// Where the tables of a group are.
#[derive(Clone, Debug, Default)]
struct Header {
    base: BoxLanes,
    /// The largest absolute base coordinate in the group.
    base_reach: f32,
    targets: Range<usize>,
}

/// The tables of all groups, one after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    headers: Vec<Header>,
    targets: Vec<LocalTarget>,
    slopes: Vec<Slopes>,
}

/// The tables of one group; `targets` and `slopes` go together, most gain per unit of budget first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroupTables<'a> {
    pub(crate) base: &'a BoxLanes,
    pub(crate) base_reach: f32,
    pub(crate) targets: &'a [LocalTarget],
    pub(crate) slopes: &'a [Slopes],
}

impl Tables {
    #[inline]
    pub(crate) fn group(&self, group: usize) -> GroupTables<'_> {
        let header = &self.headers[group];
        GroupTables {
            base: &header.base,
            base_reach: header.base_reach,
            targets: &self.targets[header.targets.clone()],
            slopes: &self.slopes[header.targets.clone()],
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.headers) + size_of_val(&*self.targets) + size_of_val(&*self.slopes)
    }

    /// Makes room for the next group in preorder.
    pub(super) fn reserve(&mut self) {
        self.headers.push(Header::default());
    }

    /// Fills a group's tables from what its children span.
    pub(super) fn fill(&mut self, group: usize, children: &[NodeExtents]) {
        let mut rows: Vec<_> = local_targets(children)
            .into_iter()
            .map(|target| row(target, children))
            .collect();
        // The sort is stable: equal gains stay in target order.
        rows.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let start = self.targets.len();
        self.targets.extend(rows.iter().map(|row| row.local));
        self.slopes.extend(rows.iter().map(|row| row.slopes));

        let mut base = BoxLanes::default();
        for (lane, child) in children.iter().enumerate() {
            base.set(lane, &child.base);
        }
        self.headers[group] = Header {
            base,
            base_reach: reach(children.iter().map(|child| child.base.magnitude())),
            targets: start..self.targets.len(),
        };
    }
}

/// One target's tables, and how much tighter its reference slopes are than its interval ones.
struct Row {
    local: LocalTarget,
    slopes: Slopes,
    gain: f64,
}

fn row(target: u32, children: &[NodeExtents]) -> Row {
    let mut slopes = Slopes {
        reference: BoxLanes::default(),
        interval: BoxLanes::default(),
    };
    let mut gain = 0.0;
    for (lane, child) in children.iter().enumerate() {
        let Some((reference, displacement)) = child.under(target) else {
            continue;
        };
        let slope = reference_slope(&child.base, &reference);
        let tighter = (slope.min - displacement.min).as_dvec3() + (displacement.max - slope.max).as_dvec3();
        gain += tighter.element_sum();
        slopes.reference.set(lane, &slope);
        slopes.interval.set(lane, &displacement);
    }
    let moved = children.iter().filter_map(|child| child.under(target));
    Row {
        local: LocalTarget {
            target,
            reach: reach(moved.map(|(_, displacement)| displacement.magnitude())),
        },
        slopes,
        gain,
    }
}

/// How far each end moves from the base box to the reference box, rounded outward.
fn reference_slope(base: &Aabb, reference: &Extent) -> Aabb {
    let (base_min, base_max) = (base.min.as_dvec3(), base.max.as_dvec3());
    // The sum behind `reference` and this difference are each rounded once in f64.
    let pad = |r: DVec3, b: DVec3| (r.abs() + b.abs()) * f64::EPSILON * 2.0;
    let min = reference.min - base_min - pad(reference.min, base_min);
    let max = reference.max - base_max + pad(reference.max, base_max);
    Aabb {
        min: min.as_vec3().map(f32::next_down),
        max: max.as_vec3().map(f32::next_up),
    }
}

fn reach(magnitudes: impl Iterator<Item = Vec3>) -> f32 {
    magnitudes.fold(0.0, |reach, m| reach.max(m.max_element()))
}
