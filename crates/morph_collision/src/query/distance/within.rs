//! The search for all pairs of triangles that are closer than a distance.

use std::ops::ControlFlow;

use super::closest_pair::ClosestPair;
use super::search::{LeafTriangles, Search};
use crate::bounds::Extent;
use crate::exact::Triangle;
use crate::query::rank::MARGIN;
use crate::query::stats::QueryStats;
use crate::query::triangle_pair::TrianglePair;
use crate::query::two_bodies::Collapsed;

/// Passes all pairs of at most a distance to a visitor.
pub(super) struct Within<V> {
    max_distance: f64,
    limit: f64,
    visitor: V,
}

impl<V: FnMut(ClosestPair) -> ControlFlow<()>> Within<V> {
    pub(super) fn new(max_distance: f64, visitor: V) -> Self {
        Self {
            max_distance,
            // The margin is for rounding.
            limit: max_distance * max_distance * MARGIN,
            visitor,
        }
    }

    /// Measures two triangles and passes them on if they are close enough.
    pub(super) fn measure(
        &mut self,
        pair: TrianglePair,
        corners_a: &Triangle,
        corners_b: &Triangle,
    ) -> ControlFlow<()> {
        let (found, _) = ClosestPair::measure(pair, corners_a, corners_b);
        match found.distance <= self.max_distance {
            true => (self.visitor)(found),
            false => ControlFlow::Continue(()),
        }
    }
}

impl<V: FnMut(ClosestPair) -> ControlFlow<()>> Search for Within<V> {
    fn limit(&self) -> f64 {
        self.limit
    }

    fn at_leaves(&mut self, a: LeafTriangles<'_>, b: LeafTriangles<'_>, tests: &mut u64) -> ControlFlow<(), f64> {
        for &(triangle_a, ref corners_a) in a.triangles {
            let extent_a = Extent::of_triangle(corners_a);
            for &(triangle_b, ref corners_b) in b.triangles {
                if extent_a.squared_distance(&Extent::of_triangle(corners_b)) <= self.limit {
                    *tests += 1;
                    self.measure(TrianglePair { triangle_a, triangle_b }, corners_a, corners_b)?;
                }
            }
        }
        ControlFlow::Continue(self.limit)
    }

    fn at_collapsed(&mut self, bodies: &mut Collapsed, stats: &mut QueryStats) {
        let limit = self.limit;
        let _stopped_early = bodies.near(limit, stats, |pair, corners_a, corners_b| {
            self.measure(pair, corners_a, corners_b)
        });
    }
}
