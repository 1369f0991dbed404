//! What a pose blends: per group of children the base volumes and, per local target, how they move.
//!
//! With `s` an end of a child's base volume and `w_k` the weights, the posed end is bounded by
//!
//! ```text
//! s + sum_(k,S) a_(k,S) X_k(S) + sum_k r_k X_k(inf),   sum_S a_(k,S) + r_k = w_k,   a >= 0,   sum a_(k,S) / S <= 1
//! ```
//!
//! The last condition is the *budget*. `X_k(S)` moves the end towards that of the reference scaled by `S`, which is the
//! paper's blending for `S = 1` (Eq. 3); `X_k(inf)` moves it by the extreme displacement, which is interval arithmetic,
//! costs no budget and holds for any weights. Reflected references serve negative weights the same way. Every slope is
//! rounded outward. Spending the budget is a fractional knapsack: the *steps* of a group are in the order of gain per cost.

use std::ops::Range;

use super::columns::{Columns, Shape};
use super::extents::{NodeExtents, TargetExtents, local_targets};
use super::slopes::{Slopes, SlopesView};
use crate::bounds::Volume;
use crate::model::MorphModel;

/// A target that moves some child of a group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalTarget {
    pub(crate) target: u32,
    /// The largest absolute displacement in the group.
    pub(crate) reach: f32,
}

/// Moving some weight of a local target from a larger scale, or from the interval, to a smaller, tighter one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Index among the group's local targets.
    pub(crate) local: u32,
    /// The earlier step of the same target whose weight this one takes over; none takes from the interval.
    pub(crate) after: Option<u32>,
    /// Budget per unit of weight, rounded up.
    pub(crate) cost: f32,
    /// Whether this is for a negative weight: a reflected reference.
    pub(crate) negative: bool,
}

impl Step {
    /// Takes a positive weight from the interval to the reference at scale 1. No target has two of these.
    fn is_whole(&self) -> bool {
        !self.negative && self.after.is_none() && self.cost == 1.0
    }
}

/// Where the tables of a group are.
#[derive(Clone, Debug)]
struct Header {
    base_reach: f32,
    targets: Range<usize>,
    /// Into `intervals`: as many as targets, or none where all children are leaves that are fitted to their vertices.
    intervals: usize,
    steps: Range<usize>,
    /// Lanes that have tables.
    lanes: u8,
    whole_weights: bool,
}

/// The tables of all groups, one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Tables<V> {
    headers: Vec<Header>,
    base: Vec<V>,
    targets: Vec<LocalTarget>,
    intervals: Slopes<V>,
    steps: Vec<Step>,
    references: Slopes<V>,
}

/// The tables of one group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroupTables<'a, V> {
    /// Lanes that are blended from these tables, as a bit mask; the others are fitted to their vertices.
    pub(crate) lanes: u8,
    pub(crate) base: &'a V,
    pub(crate) base_reach: f32,
    pub(crate) targets: &'a [LocalTarget],
    /// `X(inf)`, one per target.
    pub(crate) intervals: SlopesView<'a, V>,
    /// Most gain per budget first.
    pub(crate) steps: &'a [Step],
    /// Whether every target has one step, to the reference at scale 1 for positive weights: weights that the budget holds are then
    /// taken as they are.
    pub(crate) whole_weights: bool,
    /// `X(S)`, one per step, for a weight's magnitude.
    pub(crate) references: SlopesView<'a, V>,
}

impl<V: Volume> Tables<V> {
    pub(super) fn new(compact: bool) -> Self {
        Self {
            headers: Vec::new(),
            base: Vec::new(),
            targets: Vec::new(),
            intervals: Slopes::new(compact),
            steps: Vec::new(),
            references: Slopes::new(compact),
        }
    }

    #[inline]
    pub(crate) fn group(&self, group: usize) -> GroupTables<'_, V> {
        let header = &self.headers[group];
        let intervals = if header.lanes == 0 { 0 } else { header.targets.len() };
        GroupTables {
            lanes: header.lanes,
            base: &self.base[group],
            base_reach: header.base_reach,
            targets: &self.targets[header.targets.clone()],
            intervals: self.intervals.view(header.intervals..header.intervals + intervals),
            steps: &self.steps[header.steps.clone()],
            whole_weights: header.whole_weights,
            references: self.references.view(header.steps.clone()),
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.headers)
            + size_of_val(&*self.base)
            + size_of_val(&*self.targets)
            + self.intervals.bytes()
            + size_of_val(&*self.steps)
            + self.references.bytes()
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
            intervals: 0,
            steps: 0..0,
            lanes: 0,
            whole_weights: false,
        });
        self.base.push(V::default());
    }

    /// Fills a group's tables from what its children span; `lanes` are those that are to have tables.
    pub(super) fn fill(
        &mut self,
        group: usize,
        model: &MorphModel,
        columns: &Columns,
        children: &[NodeExtents<V>],
        lanes: u8,
    ) {
        let measure = Measure {
            model,
            columns,
            children,
            lanes,
        };
        let bases = measure.bases();
        for (lane, base) in bases.iter().enumerate() {
            self.base[group].set(lane, base);
        }
        let locals = local_targets(children);
        let targets = self.targets.len();
        let (intervals, steps) = (self.intervals.len(), self.steps.len());
        let mut ladders = Vec::new();
        for (local, &target) in locals.iter().enumerate() {
            let under = children.iter().filter_map(|child| child.under(target));
            self.targets.push(LocalTarget {
                target,
                reach: under.fold(0.0, |reach, t| reach.max(t.reach)),
            });
            if lanes != 0 {
                let (interval, looseness) = measure.interval(target);
                self.intervals.push(interval);
                for negative in [false, true] {
                    ladders.extend(measure.ladder(&bases, local as u32, target, looseness, negative));
                }
            }
        }
        // Within a target gains per cost fall, so a stable sort leaves each step after the one it follows.
        ladders.sort_by(|a, b| b.density.total_cmp(&a.density));
        for (i, rung) in ladders.iter().enumerate() {
            let same = |earlier: &Rung<V>| {
                earlier.step.local == rung.step.local && earlier.step.negative == rung.step.negative
            };
            let after = ladders[..i].iter().rposition(same).map(|j| j as u32);
            self.steps.push(Step { after, ..rung.step });
            self.references.push(rung.slopes);
        }
        self.headers[group] = Header {
            base_reach: children.iter().fold(0.0, |reach, c| reach.max(c.base_reach)),
            targets: targets..self.targets.len(),
            intervals,
            // A second step of a target comes after the first.
            whole_weights: self.steps.len() - steps == locals.len() && self.steps[steps..].iter().all(Step::is_whole),
            steps: steps..self.steps.len(),
            lanes,
        };
    }
}

/// A step and its slopes, before the group's steps are put in order.
struct Rung<V> {
    step: Step,
    slopes: V,
    looseness: f64,
    inverse_scale: f64,
    density: f64,
}

/// The children of a group that have tables, and how to measure them.
struct Measure<'a, V: Volume> {
    model: &'a MorphModel,
    columns: &'a Columns,
    children: &'a [NodeExtents<V>],
    lanes: u8,
}

impl<V: Volume> Measure<'_, V> {
    fn points<'b>(&'b self, child: &'b NodeExtents<V>, shape: Shape) -> impl Fn(&mut dyn FnMut(glam::DVec3)) + 'b {
        move |each| self.columns.for_each_point(self.model, &child.vertices, shape, each)
    }

    fn bases(&self) -> Vec<V::One> {
        let base = |child: &NodeExtents<V>| V::base(&child.base, &self.points(child, Shape::Base));
        self.children.iter().map(base).collect()
    }

    /// Slopes of one target for every lane it moves, and their summed looseness.
    fn lanes(&self, target: u32, slope: impl Fn(usize, &NodeExtents<V>, &TargetExtents<V>) -> V::One) -> (V, f64) {
        let (mut all, mut looseness) = (V::default(), 0.0);
        for (lane, child) in self.children.iter().enumerate() {
            if self.lanes >> lane & 1 == 0 {
                continue;
            }
            if let Some(extents) = child.under(target) {
                let one = slope(lane, child, extents);
                looseness += V::looseness(&one);
                all.set(lane, &one);
            }
        }
        (all, looseness)
    }

    fn interval(&self, target: u32) -> (V, f64) {
        self.lanes(target, |_, child, extents| {
            V::interval(&extents.displacement, &self.points(child, Shape::Displacement(target)))
        })
    }

    /// The scales of one target and sign that gain, loosest first, each with its gain per budget over the one before.
    fn ladder(&self, bases: &[V::One], local: u32, target: u32, interval: f64, negative: bool) -> Vec<Rung<V>> {
        let mut ladder: Vec<Rung<V>> = Vec::new();
        for (s, scale) in self.columns.scales().enumerate() {
            if (scale < 0.0) != negative {
                continue;
            }
            let (slopes, looseness) = self.lanes(target, |lane, child, extents| {
                let points = self.points(child, Shape::Reference(target, scale));
                V::slope(&bases[lane], &extents.references[s], &points, scale.abs())
            });
            let mut rung = Rung {
                step: Step {
                    local,
                    after: None,
                    cost: 0.0,
                    negative,
                },
                slopes,
                looseness,
                inverse_scale: 1.0 / scale.abs(),
                density: 0.0,
            };
            // The upper hull of gain over cost: a rung that gains less per budget than the next one is skipped.
            loop {
                let (below, paid) = ladder
                    .last()
                    .map_or((interval, 0.0), |last| (last.looseness, last.inverse_scale));
                rung.density = (below - rung.looseness) / (rung.inverse_scale - paid);
                rung.step.cost = crate::bounds::up(rung.inverse_scale - paid);
                match ladder.last() {
                    Some(last) if last.density <= rung.density => ladder.pop(),
                    _ => break,
                };
            }
            if rung.density > 0.0 {
                ladder.push(rung);
            }
        }
        ladder
    }
}
