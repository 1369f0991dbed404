use std::ops::ControlFlow;

use glam::DVec3;

use super::leaves::place_leaf;
use super::stats::QueryStats;
use crate::bounds::{Box64, WorldFromModel};
use crate::exact::Triangle;
use crate::pose::Posed;
use crate::traverse::{OneWalk, Queue};
use crate::tree::CornerLanes;

/// The memory of a query over one body, and the way it goes about it.
#[derive(Debug, Default)]
pub(super) struct OneBody {
    queue: Queue,
    posed: Vec<CornerLanes>,
    placed: Vec<(u32, Triangle)>,
}

impl OneBody {
    /// Calls `at_triangle` with the number and the world-space corners of every triangle in a leaf that `bound` lets through
    /// at most at the limit, leaves with lower bounds first. It returns the new limit, or breaks.
    pub(super) fn walk(
        &mut self,
        tree: &mut Posed<'_>,
        world_from_model: &WorldFromModel,
        limit: f64,
        bound: impl Fn(&Box64) -> Option<f64>,
        mut at_triangle: impl FnMut(u32, &Triangle) -> ControlFlow<(), f64>,
    ) -> QueryStats {
        let before = tree.blended();
        let mut walk = OneWalk { tree, node_tests: 0 };
        let mut triangle_tests = 0;
        let Self { queue, posed, placed } = self;
        let _stopped_early = walk.run(
            queue,
            limit,
            |bounds| bound(&Box64::of(bounds)),
            |tree, leaf| {
                placed.clear();
                place_leaf(tree, world_from_model, leaf, posed, placed);
                let mut limit = f64::INFINITY;
                for (number, triangle) in &*placed {
                    triangle_tests += 1;
                    limit = at_triangle(*number, triangle)?;
                }
                ControlFlow::Continue(limit)
            },
        );
        let after = walk.tree.blended();
        QueryStats {
            node_tests: walk.node_tests,
            triangle_tests,
            ..QueryStats::blending([before], [after])
        }
    }
}

/// The largest absolute model-space coordinates of a posed tree.
pub(super) fn magnitude(tree: &mut Posed<'_>) -> DVec3 {
    tree.bounds().magnitude().as_dvec3()
}
