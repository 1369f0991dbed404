use std::ops::ControlFlow;

use glam::DVec3;

use super::body::world_triangle;
use super::stats::QueryStats;
use crate::bounds::{Box64, WorldFromModel};
use crate::exact::Triangle;
use crate::pose::Posed;
use crate::traverse::{OneWalk, Queue};

/// The memory of a query over one body, and the way it goes about it.
#[derive(Debug, Default)]
pub(super) struct OneBody {
    queue: Queue,
    numbers: Vec<u32>,
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
        let Self { queue, numbers } = self;
        let _stopped_early = walk.run(
            queue,
            limit,
            |bounds| bound(&Box64::of(bounds)),
            |tree, leaf| {
                numbers.clear();
                numbers.extend_from_slice(tree.topology.leaf_triangles(leaf));
                let mut limit = f64::INFINITY;
                for &number in &*numbers {
                    triangle_tests += 1;
                    limit = at_triangle(number, &world_triangle(tree, world_from_model, number))?;
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
