use std::ops::ControlFlow;

use glam::DVec3;

use super::ClosestPair;
use crate::exact::{ClosestPoints, Triangle, closest_of_triangles};
use crate::query::pairs::TrianglePair;

/// Distances may be off by their rounding: what may be closer by no more than that is measured, so that ties end the same for every tree.
const MARGIN: f64 = 1.0 + 1e-9;

/// How many pairs at the closest distance are measured before others that cannot be closer are passed over. Measuring a pair takes about 0.4
/// microseconds, so this bounds a query's time in bodies that are flattened to parallel lines.
const TIES: u32 = 16_384;

/// What cannot be closer than this part of the distance is as close, but for rounding: the closest points are known to about `1e-16` of
/// the bodies' size, so for bodies more than a thousandth of their size apart the line between the points is known well enough.
const NO_CLOSER: f64 = 1.0 - 1e-9;

/// The closest triangles so far.
pub(super) struct Best {
    pub(super) pair: Option<ClosestPair>,
    squared: f64,
    max_distance: f64,
    /// Whether near ties are looked at.
    with_ties: bool,
    /// How many pairs have been measured that are about as close.
    ties: u32,
    /// A squared distance: pairs with a lower bound above it are not worth looking at.
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

    /// Measures two triangles and returns the new limit; breaks if they share a point.
    #[inline]
    pub(super) fn look(
        &mut self,
        pair: TrianglePair,
        corners_a: &Triangle,
        corners_b: &Triangle,
    ) -> ControlFlow<(), f64> {
        let ClosestPoints { on_a, on_b, squared } = closest_of_triangles(corners_a, corners_b);
        let found = ClosestPair {
            triangle_a: pair.triangle_a,
            triangle_b: pair.triangle_b,
            point_a: on_a,
            point_b: on_b,
            distance: squared.sqrt(),
        };
        if squared * MARGIN < self.squared {
            self.ties = 0;
        } else if squared <= self.squared * MARGIN {
            self.ties = self.ties.saturating_add(1);
        }
        let closer = self
            .pair
            .as_ref()
            .is_none_or(|best| squared < self.squared || (squared == self.squared && found.is_before(best)));
        if found.distance <= self.max_distance && closer {
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

    /// Whether so many pairs were as close as the closest that two triangles which cannot be closer need not be measured.
    #[inline]
    pub(super) fn is_tied_enough(&self, corners_a: &Triangle, corners_b: &Triangle) -> bool {
        self.ties > TIES && self.are_no_closer(corners_a, corners_b)
    }

    /// Whether two triangles are as far apart as the closest pair along the line between its points, up to rounding.
    fn are_no_closer(&self, corners_a: &Triangle, corners_b: &Triangle) -> bool {
        let Some(best) = &self.pair else { return false };
        let across = best.point_b - best.point_a;
        let along = |corner: DVec3| (corner - best.point_a).dot(across);
        let [a, b, c] = corners_a.map(along);
        let [d, e, f] = corners_b.map(along);
        d.min(e).min(f) - a.max(b).max(c) >= self.squared * NO_CLOSER
    }
}

impl ClosestPair {
    fn is_before(&self, other: &Self) -> bool {
        (self.triangle_a, self.triangle_b) < (other.triangle_a, other.triangle_b)
    }
}
