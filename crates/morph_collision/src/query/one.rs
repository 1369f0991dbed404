use std::ops::ControlFlow;

use super::body::Body;
use super::leaves::place_leaf;
use super::stats::QueryStats;
use crate::bounds::Box64;
use crate::exact::Triangle;
use crate::traverse::{OneWalk, Queue};
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
    /// Visits leaves in ascending order of `lower_bound` and calls `at_triangle` with the number and the world-space corners of each
    /// triangle. Ends when the lowest bound left exceeds the limit, or at a break, which it passes on.
    ///
    /// `lower_bound` maps a node's model-space box to a lower bound for its triangles, `None` to skip the node.
    /// `at_triangle` returns the new limit.
    pub(super) fn walk(
        &mut self,
        mut body: Body<'_>,
        limit: f64,
        lower_bound: impl Fn(&Box64) -> Option<f64>,
        mut at_triangle: impl FnMut(u32, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let tree = &mut body.posed();
        let before = tree.blended();
        let mut walk = OneWalk { tree, node_tests: 0 };
        let mut triangle_tests = 0;
        let flow = walk.run(
            &mut self.queue,
            limit,
            |bounds| lower_bound(&Box64::of(bounds)),
            |tree, leaf| {
                self.placed.clear();
                place_leaf(tree, leaf, &mut self.posed, &mut self.placed);
                let mut limit = f64::INFINITY;
                for (number, triangle) in &self.placed {
                    triangle_tests += 1;
                    limit = at_triangle(*number, triangle)?;
                }
                ControlFlow::Continue(limit)
            },
        );
        self.stats = QueryStats {
            node_tests: walk.node_tests,
            triangle_tests,
            ..QueryStats::blending([before], [walk.tree.blended()])
        };
        flow
    }
}
