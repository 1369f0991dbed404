//! The search for the closest pair of triangles.

use std::ops::ControlFlow;

use glam::DVec3;

use super::closest_pair::ClosestPair;
use super::search::{LeafTriangles, Search};
use crate::bounds::Extent;
use crate::exact::Triangle;
use crate::query::rank::MARGIN;
use crate::query::stats::QueryStats;
use crate::query::triangle_pair::TrianglePair;
use crate::query::two_bodies::Collapsed;
use crate::tree::Leaf;

/// After this many pairs at the closest distance, the query skips others that cannot be closer. Measuring a pair takes about 0.4
/// microseconds, so this bounds the time for bodies flattened to parallel lines.
const TIES: u32 = 16_384;

/// A pair whose lower bound exceeds this share of the distance counts as equally close. The closest points have errors of about 1e-16
/// of the bodies' size, so the direction between them is accurate enough if the bodies are more than a thousandth of their size apart.
const NO_CLOSER: f64 = 1.0 - 1e-9;

/// The search for the closest pair within a distance.
pub(super) struct Closest {
    best: Best,
    repeats: [Repeats; 2],
}

impl Closest {
    /// Near ties are measured if `with_ties`, so that the answer does not depend on the trees.
    pub(super) fn new(max_distance: f64, with_ties: bool) -> Self {
        Self {
            best: Best::within(max_distance, with_ties),
            repeats: [Repeats::default(); 2],
        }
    }

    pub(super) fn found(self) -> Option<ClosestPair> {
        self.best.pair
    }
}

impl Search for Closest {
    fn limit(&self) -> f64 {
        self.best.limit
    }

    fn at_leaves(&mut self, a: LeafTriangles<'_>, b: LeafTriangles<'_>, tests: &mut u64) -> ControlFlow<(), f64> {
        let Self {
            best,
            repeats: [repeats_a, repeats_b],
        } = self;
        let are_new = b
            .triangles
            .iter()
            .filter(|(number, corners)| repeats_b.is_new(a.leaf, *number, corners));
        if are_new.count() == 0 {
            return ControlFlow::Continue(best.limit);
        }
        for &(triangle_a, ref corners_a) in a.triangles {
            if !repeats_a.is_new(b.leaf, triangle_a, corners_a) {
                continue;
            }
            let extent_a = Extent::of_triangle(corners_a);
            for &(triangle_b, ref corners_b) in b.triangles {
                // The limit has a margin for rounding.
                let is_farther = extent_a.squared_distance(&Extent::of_triangle(corners_b)) > best.limit;
                if is_farther || best.is_tied_enough(corners_a, corners_b) {
                    continue;
                }
                *tests += 1;
                best.measure(TrianglePair { triangle_a, triangle_b }, corners_a, corners_b)?;
            }
        }
        ControlFlow::Continue(best.limit)
    }

    fn at_collapsed(&mut self, bodies: &mut Collapsed, stats: &mut QueryStats) {
        let (limit, best) = (self.best.limit, &mut self.best);
        let measure = |pair, corners_a: &Triangle, corners_b: &Triangle| best.measure(pair, corners_a, corners_b);
        let _stopped_early = bodies.nearest(limit, stats, measure);
    }
}

/// The closest pair so far.
struct Best {
    pair: Option<ClosestPair>,
    squared: f64,
    max_distance: f64,
    /// Whether to measure near ties.
    with_ties: bool,
    /// The number of measured pairs that were about equally close.
    ties: u32,
    /// A squared distance. Pairs with a greater lower bound are skipped.
    limit: f64,
}

impl Best {
    fn within(max_distance: f64, with_ties: bool) -> Self {
        Self {
            pair: None,
            squared: f64::INFINITY,
            max_distance,
            with_ties,
            ties: 0,
            limit: max_distance * max_distance * MARGIN,
        }
    }

    /// Measures two triangles and returns the new limit. Breaks if they share a point.
    #[inline]
    fn measure(&mut self, triangles: TrianglePair, corners_a: &Triangle, corners_b: &Triangle) -> ControlFlow<(), f64> {
        let (found, squared) = ClosestPair::measure(triangles, corners_a, corners_b);
        if squared * MARGIN < self.squared {
            self.ties = 0;
        } else if squared <= self.squared * MARGIN {
            self.ties = self.ties.saturating_add(1);
        }
        let is_closer = |best: &ClosestPair| found.rank() < best.rank();
        if found.distance <= self.max_distance && self.pair.as_ref().is_none_or(is_closer) {
            self.pair = Some(found);
            self.squared = squared;
            if squared == 0.0 {
                return ControlFlow::Break(());
            }
            let limit = if self.with_ties {
                squared * MARGIN
            } else {
                squared.next_down()
            };
            self.limit = limit.min(self.limit);
        }
        ControlFlow::Continue(self.limit)
    }

    /// Whether to skip two triangles, because there were many ties already and these are at least as far apart as the closest pair.
    /// That is measured along the line between the closest points, up to rounding.
    #[inline]
    fn is_tied_enough(&self, corners_a: &Triangle, corners_b: &Triangle) -> bool {
        self.ties > TIES
            && self.pair.as_ref().is_some_and(|best| {
                let across = best.point_b - best.point_a;
                let along = |corner: DVec3| (corner - best.point_a).dot(across);
                let [a, b, c] = corners_a.map(along);
                let [d, e, f] = corners_b.map(along);
                d.min(e).min(f) - a.max(b).max(c) >= self.squared * NO_CLOSER
            })
    }
}

/// Recognises triangles of a body that is a point. All its leaves would be compared with every leaf of the other body that is about as
/// close.
#[derive(Clone, Copy, Debug, Default)]
struct Repeats(Option<(Leaf, u32, Triangle)>);

impl Repeats {
    /// Whether a triangle differs from the last one that was compared with a leaf, or has a smaller number.
    fn is_new(&mut self, leaf: Leaf, number: u32, corners: &Triangle) -> bool {
        let is_repeated = self.0.as_ref().is_some_and(|(last_leaf, last_number, last)| {
            *last_leaf == leaf && *last_number < number && last == corners
        });
        if !is_repeated {
            self.0 = Some((leaf, number, *corners));
        }
        !is_repeated
    }
}
