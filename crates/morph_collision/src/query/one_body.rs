//! The walk that queries about one body share.

use std::ops::ControlFlow;

use super::body::Body;
use super::leaves::place_leaf;
use super::stats::QueryStats;
use crate::bounds::LowerBounds;
use crate::exact::Triangle;
use crate::pose::Posed;
use crate::traverse::{Queue, walk_one};
use crate::tree::{CornerLanes, Leaf};

/// The walk that all queries about one body share, and its scratch memory.
#[derive(Debug, Default)]
pub(super) struct OneBody {
    queue: Queue,
    posed: Vec<CornerLanes>,
    placed: Vec<(u32, Triangle)>,
    pub(super) stats: QueryStats,
}

impl OneBody {
    /// Visits leaves in ascending order of their lower bounds and calls `at_triangle` with the index and the world-space corners of each
    /// triangle.
    ///
    /// `at_triangle` returns the new limit. The walk ends when the lowest remaining bound exceeds the limit, or when `at_triangle`
    /// breaks; a break is passed on to the caller.
    pub(super) fn walk(
        &mut self,
        body: Body<'_>,
        limit: f64,
        bounds: &impl LowerBounds,
        mut at_triangle: impl FnMut(u32, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let (mut posed, mut placed) = (std::mem::take(&mut self.posed), std::mem::take(&mut self.placed));
        let flow = self.walk_leaves(body, limit, bounds, |tree, leaf| {
            placed.clear();
            place_leaf(tree, leaf, &mut posed, &mut placed);
            let mut limit = f64::INFINITY;
            for (number, triangle) in &placed {
                limit = at_triangle(*number, triangle)?;
            }
            ControlFlow::Continue(limit)
        });
        (self.posed, self.placed) = (posed, placed);
        flow
    }

    /// Like [`OneBody::walk`], but calls `at_leaf` once per leaf.
    pub(super) fn walk_leaves(
        &mut self,
        mut body: Body<'_>,
        limit: f64,
        bounds: &impl LowerBounds,
        mut at_leaf: impl FnMut(&mut Posed<'_>, Leaf) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let tree = &mut body.posed();
        let before = tree.blended();
        let (mut node_tests, mut triangle_tests) = (0, 0);
        let flow = walk_one(tree, &mut self.queue, limit, bounds, &mut node_tests, |tree, leaf| {
            triangle_tests += tree.topology.leaf_range(leaf).len() as u64;
            at_leaf(tree, leaf)
        });
        self.stats = QueryStats {
            node_tests,
            triangle_tests,
            ..QueryStats::blending([before], [tree.blended()])
        };
        flow
    }
}
