use std::ops::ControlFlow;

use super::body::Body;
use super::leaves::place_leaf;
use super::stats::QueryStats;
use crate::bounds::LowerBounds;
use crate::exact::Triangle;
use crate::traverse::{Queue, walk_one};
use crate::tree::CornerLanes;

/// The walk that all queries about one body share, and its scratch memory.
#[derive(Debug, Default)]
pub(super) struct OneBody {
    queue: Queue,
    posed: Vec<CornerLanes>,
    placed: Vec<(u32, Triangle)>,
    pub(super) stats: QueryStats,
}

impl OneBody {
    /// Visits leaves in ascending order of their lower bounds and calls `at_triangle` with the number and the world-space corners of each
    /// triangle. Ends when the lowest bound left exceeds the limit, or at a break, which it passes on.
    ///
    /// `at_triangle` returns the new limit.
    pub(super) fn walk(
        &mut self,
        mut body: Body<'_>,
        limit: f64,
        bounds: &impl LowerBounds,
        mut at_triangle: impl FnMut(u32, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let tree = &mut body.posed();
        let before = tree.blended();
        let (mut node_tests, mut triangle_tests) = (0, 0);
        let flow = walk_one(tree, &mut self.queue, limit, bounds, &mut node_tests, |tree, leaf| {
            self.placed.clear();
            place_leaf(tree, leaf, &mut self.posed, &mut self.placed);
            let mut limit = f64::INFINITY;
            for (number, triangle) in &self.placed {
                triangle_tests += 1;
                limit = at_triangle(*number, triangle)?;
            }
            ControlFlow::Continue(limit)
        });
        self.stats = QueryStats {
            node_tests,
            triangle_tests,
            ..QueryStats::blending([before], [tree.blended()])
        };
        flow
    }
}
