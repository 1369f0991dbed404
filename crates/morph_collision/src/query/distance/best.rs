use std::ops::ControlFlow;

use glam::DVec3;

use super::ClosestPair;
use crate::exact::{ClosestPoints, Triangle, closest_of_triangles};
use crate::query::pairs::TrianglePair;
use crate::query::rank::Rank;

/// Margin for rounding errors of squared distances. Pairs whose lower bound exceeds the best squared distance by up to this factor are
/// still measured, so that the answer does not depend on the tree.
pub(in crate::query) const MARGIN: f64 = 1.0 + 1e-9;

/// After this many pairs at the closest distance, the query skips others that cannot be closer. Measuring a pair takes about 0.4
/// microseconds, so this bounds the time for bodies flattened to parallel lines.
const TIES: u32 = 16_384;

/// A pair whose lower bound exceeds this share of the distance counts as equally close. The closest points have errors of about 1e-16
/// of the bodies' size, so the direction between them is accurate enough if the bodies are more than a thousandth of their size apart.
const NO_CLOSER: f64 = 1.0 - 1e-9;

impl ClosestPair {
    fn rank(&self) -> Rank<TrianglePair> {
        Rank::new(self.distance, self.triangles)
    }
}

/// The closest pair so far.
pub(super) struct Best {
    pub(super) pair: Option<ClosestPair>,
    squared: f64,
    max_distance: f64,
    /// Whether to measure near ties.
    with_ties: bool,
    /// The number of measured pairs that were about equally close.
    ties: u32,
    /// A squared distance. Pairs with a greater lower bound are skipped.
    pub(super) limit: f64,
}

impl Best {
    pub(super) fn within(max_distance: f64, with_ties: bool) -> Self {
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
    pub(super) fn look(
        &mut self,
        triangles: TrianglePair,
        corners_a: &Triangle,
        corners_b: &Triangle,
    ) -> ControlFlow<(), f64> {
        let ClosestPoints { on_a, on_b, squared } = closest_of_triangles(corners_a, corners_b);
        let found = ClosestPair {
            triangles,
            point_a: on_a,
            point_b: on_b,
            distance: squared.sqrt(),
        };
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
    pub(super) fn is_tied_enough(&self, corners_a: &Triangle, corners_b: &Triangle) -> bool {
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
