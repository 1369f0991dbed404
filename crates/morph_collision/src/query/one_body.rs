//! The walk that queries about one body share.

use std::ops::ControlFlow;

use super::body::Body;
use super::stats::QueryStats;
use crate::bounds::{Keys, LANES, LowerBounds, lanes_of, with_simd};
use crate::exact::Triangle;
use crate::traverse::{Queue, walk_one};
use crate::tree::CornerLanes;

/// The walk that all queries about one body share, and its scratch memory.
#[derive(Debug, Default)]
pub(super) struct OneBody {
    queue: Queue,
    pub(super) stats: QueryStats,
}

impl OneBody {
    /// Visits leaves in ascending order of their lower bounds and calls `at_triangle` with the index and the world-space corners of each
    /// triangle that may be within the limit.
    ///
    /// `at_triangle` returns the new limit. The walk ends when the lowest remaining bound exceeds the limit, or when `at_triangle`
    /// breaks; a break is passed on to the caller.
    ///
    /// It is compiled once for each kind of bounds, so that it stays in the processor's cache; therefore `at_triangle` is called by address.
    pub(super) fn walk(
        &mut self,
        mut body: Body<'_>,
        mut limit: f64,
        bounds: &impl LowerBounds,
        at_triangle: &mut dyn FnMut(u32, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let tree = &mut body.posed();
        let before = tree.blended();
        let (mut node_tests, mut triangle_tests) = (0, 0);
        let (queue, key) = (&mut self.queue, bounds.key(limit));
        let flow = walk_one(tree, queue, key, bounds, &mut node_tests, |tree, leaf, mut key| {
            let numbers = tree.topology.leaf_triangles(leaf);
            triangle_tests += numbers.len() as u64;
            for (patch, numbers) in numbers.chunks(LANES).enumerate() {
                let (mut corners, mut keys) = (CornerLanes::default(), Keys::default());
                let candidates = with_simd!(tree.level, simd => {
                    tree.box_corners(simd, leaf, patch, &mut corners);
                    bounds.triangles(simd, &corners, key, &mut keys)
                });
                for lane in lanes_of(candidates).take_while(|lane| *lane < numbers.len()) {
                    if keys[lane % LANES] > key {
                        continue;
                    }
                    let triangle = tree.patch_triangle(leaf, patch * LANES + lane, &corners);
                    let before = limit;
                    limit = at_triangle(numbers[lane], &triangle)?;
                    if limit != before {
                        key = bounds.key(limit);
                    }
                }
            }
            ControlFlow::Continue(key)
        });
        self.stats = QueryStats {
            node_tests,
            triangle_tests,
            ..QueryStats::blending([before], [tree.blended()])
        };
        flow
    }
}
