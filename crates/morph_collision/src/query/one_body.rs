//! The walk that queries about one body share.

use std::ops::ControlFlow;

use super::body::Body;
use super::stats::QueryStats;
use crate::bounds::{BoxLanes, LANES, LowerBounds, with_simd};
use crate::exact::Triangle;
use crate::pose::Posed;
use crate::traverse::{Queue, walk_one};
use crate::tree::{CornerLanes, Leaf};

/// The walk that all queries about one body share, and its scratch memory.
#[derive(Debug, Default)]
pub(super) struct OneBody {
    queue: Queue,
    pub(super) stats: QueryStats,
}

impl OneBody {
    /// Visits leaves in ascending order of their lower bounds and calls `at_triangle` with the index and the world-space corners of each
    /// triangle whose own box is within the limit.
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
        let mut limit = limit;
        self.walk_leaves(body, limit, bounds, |tree, leaf| {
            let numbers = tree.topology.leaf_triangles(leaf);
            for (patch, numbers) in numbers.chunks(LANES).enumerate() {
                let (mut corners, mut lowest) = (CornerLanes::default(), [0.0; LANES]);
                let (error, lanes) = (tree.corner_error(), u8::MAX >> (LANES - numbers.len()));
                let within = with_simd!(tree.level, simd => {
                    tree.box_corners(simd, leaf, patch, &mut corners);
                    let boxes = BoxLanes::of_triangles(simd, &corners, error);
                    bounds.lower_bounds(simd, &boxes, lanes, limit, &mut lowest)
                });
                for (lane, &number) in numbers.iter().enumerate() {
                    if within >> lane & 1 == 1 && lowest[lane] <= limit {
                        let triangle = tree.patch_triangle(leaf, patch * LANES + lane, &corners);
                        limit = at_triangle(number, &triangle)?;
                    }
                }
            }
            ControlFlow::Continue(limit)
        })
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
