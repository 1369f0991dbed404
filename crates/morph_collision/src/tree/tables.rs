//! What a pose blends: for each group, the base boxes of its children and how each target moves them.
//!
//! Let `s` be an end of a child's base box and `w_k` the weights. The posed end is bounded by
//!
//! ```text
//! s + sum_k a_k X_k + sum_k r_k I_k,   a_k + r_k = w_k,   a >= 0,   sum a_k <= 1
//! ```
//!
//! The last condition is the *budget*.
//!
//! - `X_k` moves the end to that of the target's reference box, which is the paper's blending (Eq. 3).
//! - `I_k` moves the end by the extreme displacement. This is interval arithmetic, which costs no budget and holds for any weights.
//!
//! Every slope is rounded outward. Intervals are stored in half as many bits, because a box needs them only for what the budget does
//! not cover. Spending the budget is a fractional knapsack problem, so the targets of a group are sorted by how much tighter the
//! reference is than the interval.

use std::ops::Range;

use glam::Vec3;

use super::extents::NodeExtents;
use crate::bounds::{Aabb, BoxLanes, LANES, intervals_len, push_intervals, push_slopes, slopes_len};

/// A target that moves at least one child of a group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalTarget {
    pub(crate) target: u16,
    /// The largest absolute end of an interval in the group; no displacement is larger.
    pub(crate) reach: f32,
}

/// A group's base boxes, and the ranges of its entries.
#[derive(Clone, Default)]
struct Header {
    base: BoxLanes,
    base_reach: f32,
    targets: Range<usize>,
    /// How many targets have references. They come first.
    references: usize,
    /// The number of lanes in a row of intervals or slopes.
    width: usize,
    /// Where the intervals of the group's targets start.
    intervals: usize,
    /// Where the slopes of its references start.
    slopes: usize,
}

/// The tables of all groups.
#[derive(Clone, Default)]
pub(crate) struct Tables {
    headers: Vec<Header>,
    targets: Vec<LocalTarget>,
    order: Vec<u16>,
    intervals: Vec<u32>,
    slopes: Vec<f32>,
}

/// The tables of one group.
#[derive(Clone, Copy)]
pub(crate) struct GroupTables<'a> {
    pub(crate) base: &'a BoxLanes,
    /// The largest absolute base coordinate in the group.
    pub(crate) base_reach: f32,
    /// Sorted by descending gain of the reference over the interval.
    pub(crate) targets: &'a [LocalTarget],
    /// The indices of `targets`, in ascending order of target.
    pub(crate) order: &'a [u16],
    /// The number of lanes in a row: the number of children.
    pub(crate) width: usize,
    /// `I_k`, one per target, to be read by [`Intervals`](crate::bounds::Intervals).
    pub(crate) intervals: &'a [u32],
    /// `X_k` of the first targets, to be read by [`Slopes`](crate::bounds::Slopes): those for which the reference is tighter.
    pub(crate) references: &'a [f32],
    /// The number of targets with references.
    pub(crate) reference_count: usize,
}

impl GroupTables<'_> {
    /// The index of a target in the tables, if it moves the group.
    #[inline(always)]
    pub(crate) fn index_of(&self, target: u32) -> Option<u16> {
        let target_at = |index: u16| u32::from(self.targets[usize::from(index)].target);
        // If every target moves the group, the order is indexed by target.
        let found = match self.order.get(target as usize) {
            Some(&index) if target_at(index) == target => return Some(index),
            _ => self.order.partition_point(|&index| target_at(index) < target),
        };
        let index = *self.order.get(found)?;
        (target_at(index) == target).then_some(index)
    }
}

impl Tables {
    #[inline(always)]
    pub(crate) fn group(&self, group: usize) -> GroupTables<'_> {
        let header = &self.headers[group];
        // Rows are read eight lanes wide, the last one beyond its end.
        let intervals = header.targets.len() * intervals_len(header.width) + LANES;
        let slopes = header.references * slopes_len(header.width) + LANES;
        GroupTables {
            base: &header.base,
            base_reach: header.base_reach,
            targets: &self.targets[header.targets.clone()],
            order: &self.order[header.targets.clone()],
            width: header.width,
            intervals: &self.intervals[header.intervals..][..intervals],
            references: &self.slopes[header.slopes..][..slopes],
            reference_count: header.references,
        }
    }

    pub(super) fn group_count(&self) -> usize {
        self.headers.len()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.headers)
            + size_of_val(&*self.targets)
            + size_of_val(&*self.order)
            + size_of_val(&*self.intervals)
            + size_of_val(&*self.slopes)
    }

    /// Finishes the tables after the last group.
    pub(super) fn finish(&mut self) {
        // Rows are read eight lanes wide.
        self.intervals.extend([0; LANES]);
        self.slopes.extend([0.0; LANES]);
        self.headers.shrink_to_fit();
        self.intervals.shrink_to_fit();
        self.slopes.shrink_to_fit();
        self.targets.shrink_to_fit();
        self.order.shrink_to_fit();
    }

    /// Adds the next group in preorder, to be filled later.
    pub(super) fn reserve(&mut self) {
        self.headers.push(Header::default());
    }

    /// Fills a group's tables from the extents of each child and of all children together.
    pub(super) fn fill(&mut self, group: usize, children: &[NodeExtents], whole: &NodeExtents) {
        let bases: Vec<Aabb> = children.iter().map(|child| child.base.outward()).collect();
        let mut columns: Vec<Column> = whole
            .targets
            .iter()
            .map(|of_target| {
                let local = LocalTarget {
                    target: of_target.target,
                    reach: of_target.interval().magnitude().max_element(),
                };
                Column::new(local, children, &bases)
            })
            .collect();
        columns.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let header = &mut self.headers[group];
        header.width = children.len();
        (header.intervals, header.slopes) = (self.intervals.len(), self.slopes.len());
        let targets = self.targets.len();
        for column in &columns {
            self.targets.push(column.local);
            push_intervals(&mut self.intervals, &column.interval);
        }
        let references = columns.partition_point(|column| column.gain > 0.0);
        for column in &columns[..references] {
            push_slopes(&mut self.slopes, &column.reference);
        }
        let mut order: Vec<u16> = (0..columns.len() as u16).collect();
        order.sort_unstable_by_key(|&index| columns[usize::from(index)].local.target);
        self.order.extend(order);
        for (lane, base) in bases.iter().enumerate() {
            header.base.set(lane, base);
        }
        // The conversion is exact: it is a coordinate of the mesh.
        header.base_reach = whole.base.reach() as f32;
        header.targets = targets..self.targets.len();
        header.references = references;
    }
}

/// The slopes of one target in a group.
struct Column {
    local: LocalTarget,
    interval: Vec<Aabb>,
    reference: Vec<Aabb>,
    /// How much tighter the boxes are, per unit of weight, with the reference than with the interval.
    gain: f64,
}

impl Column {
    fn new(local: LocalTarget, children: &[NodeExtents], bases: &[Aabb]) -> Self {
        let still = Aabb::from_points([Vec3::ZERO]);
        let mut column = Self {
            local,
            interval: vec![still; children.len()],
            reference: vec![still; children.len()],
            gain: 0.0,
        };
        for (lane, (child, base)) in children.iter().zip(bases).enumerate() {
            if let Some(extents) = child.under(local.target) {
                let (interval, reference) = (extents.interval(), extents.reference.slope_from(base));
                (column.interval[lane], column.reference[lane]) = (interval, reference);
                column.gain += looseness(&interval) - looseness(&reference);
            }
        }
        column
    }
}

/// How much one unit of a slope enlarges a box, summed over the axes.
fn looseness(slope: &Aabb) -> f64 {
    (slope.max.as_dvec3() - slope.min.as_dvec3()).element_sum()
}
