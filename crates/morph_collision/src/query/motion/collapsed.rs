//! Motions of bodies that are as small as the rounding errors of their positions at the start or at the end, such as bodies that shrink to
//! a point.

use std::cell::Cell;
use std::ops::ControlFlow;

use super::leaves::AtTriangles;
use super::limit::Limit;
use super::triangle::MovingTriangle;
use crate::bounds::first_overlap;
use crate::exact::motion::MovingPoint;
use crate::query::QueryStats;
use crate::query::two_bodies::{DistinctTriangles, DistinctWalk};
use crate::traverse::Moving;

/// Both bodies' triangles at both ends. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct CollapsedMotion {
    bodies: [Triangles; 2],
    /// The work of placing them, in steps.
    placing: u64,
    walk: DistinctWalk,
}

#[derive(Debug, Default)]
struct Triangles {
    points: Vec<MovingPoint>,
    distinct: DistinctTriangles<2>,
}

/// The steps for which placing and sorting a triangle counts: about 200 ns.
const PLACING: u64 = 64;

impl CollapsedMotion {
    /// Starts a query.
    pub(super) fn begin(&mut self) {
        self.placing = 0;
    }

    /// The steps that the last query took to place triangles.
    pub(super) fn placing(&self) -> u64 {
        self.placing
    }

    /// Calls `at_triangles` for pairs of triangles that may touch at times up to `latest`, earlier ones first, until it breaks or the limit
    /// is reached. Of triangles that move alike, only the one with the lowest number is visited, and it stands
    /// for all its features. If the walk ends early, returns a time before which no others touch.
    ///
    /// Blends every vertex; `O(n log n)`.
    pub(super) fn run(
        &mut self,
        [a, b]: [&mut Moving<'_, '_>; 2],
        latest: &Cell<f64>,
        limit: &Limit,
        stats: &mut QueryStats,
        at_triangles: &mut AtTriangles<'_>,
    ) -> Option<f64> {
        let Self { bodies, placing, walk } = self;
        let [of_a, of_b] = bodies;
        let count = |body: &Moving<'_, '_>| body.ends[0].model.triangle_count() as u64;
        let most = limit.most.saturating_sub(PLACING * (count(a) + count(b)));
        if most == 0 {
            let _cut = limit.cut();
            return Some(0.0);
        }
        *placing = limit.most - most;
        of_a.fill(a);
        of_b.fill(b);
        let distinct = [&of_a.distinct, &of_b.distinct];
        let flow = walk.run(distinct, first_overlap, latest.get(), most, stats, |t, s, stats| {
            let t = MovingTriangle::of_mesh(a, &of_a.points, t[0].1);
            let s = MovingTriangle::of_mesh(b, &of_b.points, s[0].1);
            at_triangles(&t, &s, stats)?;
            ControlFlow::Continue(latest.get())
        });
        if stats.node_tests > most {
            let _cut = limit.cut();
        }
        flow.is_break().then(|| walk.lowest_left(distinct, first_overlap))
    }
}

impl Triangles {
    fn fill(&mut self, body: &mut Moving<'_, '_>) {
        let [start, end] = &mut body.ends;
        let vertices = 0..start.model.vertex_count() as u32;
        self.points.clear();
        self.points.extend(vertices.map(|vertex| MovingPoint {
            start: start.world_vertex(vertex),
            end: end.world_vertex(vertex),
        }));
        let numbers = 0..start.model.triangle_count() as u32;
        self.distinct.fill(numbers.map(|number| {
            let corners = start.model.corners(number).map(|vertex| self.points[vertex as usize]);
            [corners.map(|corner| corner.start), corners.map(|corner| corner.end)]
        }));
    }
}
