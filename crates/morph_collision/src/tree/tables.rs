//! What a pose blends: per group of children the base boxes and, per local target, how they move.
//!
//! With `s` an end of a child's base box and `w_k` the weights, the posed end is bounded by
//!
//! ```text
//! s + sum_k a_k X_k + sum_k r_k I_k,   a_k + r_k = w_k,   a >= 0,   sum a_k <= 1
//! ```
//!
//! The last condition is the *budget*. `X_k` moves the end to that of the target's reference box, which is the paper's
//! blending (Eq. 3); `I_k` moves it by the extreme displacement, which is interval arithmetic, costs no budget and holds for
//! any weights. Every slope is rounded outward. Spending the budget is a fractional knapsack: the targets of a group are in
//! the order of what a reference gains over the interval.

use std::ops::Range;

use super::extents::{NodeExtents, TargetExtents, local_targets, reach_under};
use crate::bounds::{Aabb, BoxLanes};

/// A target that moves some child of a group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalTarget {
    pub(crate) target: u32,
    /// The largest absolute displacement in the group.
    pub(crate) reach: f32,
}

/// Where the tables of a group are.
#[derive(Clone, Debug)]
struct Header {
    base_reach: f32,
    targets: Range<usize>,
    /// Of the first targets.
    references: Range<usize>,
}

/// The tables of all groups, one after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tables {
    headers: Vec<Header>,
    base: Vec<BoxLanes>,
    /// As many as `intervals`.
    targets: Vec<LocalTarget>,
    intervals: Vec<BoxLanes>,
    references: Vec<BoxLanes>,
}

/// The tables of one group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroupTables<'a> {
    pub(crate) base: &'a BoxLanes,
    pub(crate) base_reach: f32,
    /// Those whose references gain most first.
    pub(crate) targets: &'a [LocalTarget],
    /// `I_k`, one per target.
    pub(crate) intervals: &'a [BoxLanes],
    /// `X_k` of the first targets; the others' would gain nothing.
    pub(crate) references: &'a [BoxLanes],
}

impl Tables {
    #[inline]
    pub(crate) fn group(&self, group: usize) -> GroupTables<'_> {
        let header = &self.headers[group];
        GroupTables {
            base: &self.base[group],
            base_reach: header.base_reach,
            targets: &self.targets[header.targets.clone()],
            intervals: &self.intervals[header.targets.clone()],
            references: &self.references[header.references.clone()],
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.headers)
            + size_of_val(&*self.base)
            + size_of_val(&*self.targets)
            + size_of_val(&*self.intervals)
            + size_of_val(&*self.references)
    }

    /// Targets that move something in a group, summed over all groups.
    pub(super) fn local_targets(&self) -> usize {
        self.targets.len()
    }

    /// Makes room for the next group in preorder.
    pub(super) fn reserve(&mut self) {
        self.headers.push(Header {
            base_reach: 0.0,
            targets: 0..0,
            references: 0..0,
        });
        self.base.push(BoxLanes::default());
    }

    /// Fills a group's tables from what its children span.
    pub(super) fn fill(&mut self, group: usize, children: &[NodeExtents]) {
        let bases: Vec<Aabb> = children.iter().map(|child| child.base.outward()).collect();
        for (lane, base) in bases.iter().enumerate() {
            self.base[group].set(lane, base);
        }
        let measure = |target| Columns::new(children, &bases, target);
        let mut columns: Vec<Columns> = local_targets(children).into_iter().map(measure).collect();
        columns.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let (targets, references) = (self.targets.len(), self.references.len());
        for column in &columns {
            self.targets.push(column.local);
            self.intervals.push(column.interval);
            if column.gain > 0.0 {
                self.references.push(column.reference);
            }
        }
        self.headers[group] = Header {
            base_reach: children.iter().fold(0.0, |reach, c| reach.max(c.base_reach)),
            targets: targets..self.targets.len(),
            references: references..self.references.len(),
        };
    }
}

/// The slopes of one target in a group.
struct Columns {
    local: LocalTarget,
    interval: BoxLanes,
    reference: BoxLanes,
    /// How much tighter a unit of weight makes the boxes at the reference than at the interval.
    gain: f64,
}

impl Columns {
    fn new(children: &[NodeExtents], bases: &[Aabb], target: u32) -> Self {
        let mut columns = Self {
            local: LocalTarget {
                target,
                reach: reach_under(children, target),
            },
            interval: BoxLanes::default(),
            reference: BoxLanes::default(),
            gain: 0.0,
        };
        for (lane, (child, base)) in children.iter().zip(bases).enumerate() {
            if let Some(TargetExtents {
                displacement,
                reference,
                ..
            }) = child.under(target)
            {
                let (interval, reference) = (displacement.outward(), reference.slope_from(base));
                columns.interval.set(lane, &interval);
                columns.reference.set(lane, &reference);
                columns.gain += looseness(&interval) - looseness(&reference);
            }
        }
        columns
    }
}

/// How much a unit of a slope loosens a box: the sum over the axes.
fn looseness(slope: &Aabb) -> f64 {
    (slope.max.as_dvec3() - slope.min.as_dvec3()).element_sum()
}
