//! Queries for pairs of bodies that are tiny compared with their distance from the origin, or with their own rest shape: walks over their
//! [`DistinctTriangles`].

use std::ops::ControlFlow;

use super::distinct_triangles::{DistinctTriangles, DistinctWalk};
use crate::bounds::Extent;
use crate::exact::{Facet, Triangle, facets_intersect_counting, sorted};
use crate::pose::Posed;
use crate::query::stats::QueryStats;
use crate::query::triangle_pair::TrianglePair;

/// The placed triangles of two collapsed bodies. The next query reuses the memory.
#[derive(Debug, Default)]
pub(in crate::query) struct Collapsed {
    a: DistinctTriangles<1>,
    b: DistinctTriangles<1>,
    walk: DistinctWalk,
}

impl Collapsed {
    /// Replaces the triangles by those of two bodies. Blends every vertex; `O(n log n)`.
    pub(in crate::query) fn fill(&mut self, a: &mut Posed<'_>, b: &mut Posed<'_>) {
        let place = |triangles: &mut DistinctTriangles<1>, tree: &mut Posed<'_>| {
            let numbers = 0..tree.topology.triangle_count() as u32;
            // Corners are sorted, so that equal triangles are equal whatever their first corner is.
            triangles.fill(numbers.map(|number| [sorted(tree.world_triangle(number))]));
        };
        place(&mut self.a, a);
        place(&mut self.b, b);
    }

    /// Calls `visitor` for every pair of intersecting triangles until it breaks. Tests triangles with equal corners only once.
    pub(in crate::query) fn intersecting(
        &mut self,
        stats: &mut QueryStats,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Self { a, b, walk } = self;
        walk.run([a, b], squared_distance, 0.0, u64::MAX, stats, |a, b, stats| {
            let [[corners_a], [corners_b]] = [a[0].0, b[0].0];
            let undecided = &mut stats.undecided_by_filter;
            if facets_intersect_counting(&Facet::new(corners_a), &Facet::new(corners_b), undecided) {
                for &(_, triangle_a) in a {
                    for &(_, triangle_b) in b {
                        visitor(TrianglePair { triangle_a, triangle_b })?;
                    }
                }
            }
            ControlFlow::Continue(0.0)
        })
    }

    /// Calls `visitor` for pairs of triangles whose boxes are at most `limit` apart, nearest boxes first, until it breaks. `visitor`
    /// returns the new limit. Limits are squared distances. Of triangles with equal corners, only the one with the lowest index is
    /// visited.
    pub(in crate::query) fn nearest(
        &mut self,
        limit: f64,
        stats: &mut QueryStats,
        mut visitor: impl FnMut(TrianglePair, &Triangle, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let Self { a, b, walk } = self;
        walk.run([a, b], squared_distance, limit, u64::MAX, stats, |a, b, _| {
            let (([corners_a], triangle_a), ([corners_b], triangle_b)) = (a[0], b[0]);
            visitor(TrianglePair { triangle_a, triangle_b }, &corners_a, &corners_b)
        })
    }

    /// Calls `visitor` for all pairs of triangles whose boxes are at most `limit` apart, a squared distance, until it breaks.
    pub(in crate::query) fn near(
        &mut self,
        limit: f64,
        stats: &mut QueryStats,
        mut visitor: impl FnMut(TrianglePair, &Triangle, &Triangle) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Self { a, b, walk } = self;
        walk.run([a, b], squared_distance, limit, u64::MAX, stats, |a, b, _| {
            for &([corners_a], triangle_a) in a {
                for &([corners_b], triangle_b) in b {
                    visitor(TrianglePair { triangle_a, triangle_b }, &corners_a, &corners_b)?;
                }
            }
            ControlFlow::Continue(limit)
        })
    }
}

fn squared_distance([a]: &[Extent; 1], [b]: &[Extent; 1]) -> f64 {
    a.squared_distance(b)
}
