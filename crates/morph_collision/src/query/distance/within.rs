use std::ops::ControlFlow;

use super::best::MARGIN;
use super::{ClosestPair, DistanceQuery, are_far, squared_gap};
use crate::bounds::{Aabb, Box64, Extent, GapFrame};
use crate::exact::Triangle;
use crate::input_error::{InputError, check_length};
use crate::pose::Posed;
use crate::query::body::Body;
use crate::query::pairs::TrianglePair;
use crate::query::placements::Placements;
use crate::query::stats::QueryStats;
use crate::traverse::walk_nearest;

impl DistanceQuery {
    /// Calls `visitor` for every pair of triangles at most `max_distance` apart, in world units, until it breaks. Pairs that intersect have a
    /// distance of 0.
    ///
    /// The pairs do not depend on the trees, except those whose distance equals `max_distance` up to rounding. Their order does. Let the
    /// visitor break after as many pairs as you have room for: all pairs of two bodies may be this close.
    ///
    /// # Errors
    /// [`InputError`] if `max_distance` is negative or NaN.
    pub fn within(
        &mut self,
        mut a: Body<'_>,
        mut b: Body<'_>,
        max_distance: f64,
        mut visitor: impl FnMut(ClosestPair) -> ControlFlow<()>,
    ) -> Result<(), InputError> {
        check_length("max_distance", max_distance)?;
        let (a, b) = (&mut a.posed(), &mut b.posed());
        let before = [a.blended(), b.blended()];
        let placements = Placements {
            a: a.stand(),
            b: b.stand(),
        };
        let (placed_a, placed_b) = (&placements.a.placed, &placements.b.placed);
        let mut frames = GapFrame::list(placed_a, placed_b);
        if are_far(&frames, &placements) {
            frames.push(GapFrame::world(placed_a, placed_b));
        }
        let limit = max_distance * max_distance * MARGIN;
        let mut measure = |pair: TrianglePair, corners_a: &Triangle, corners_b: &Triangle| {
            let found = ClosestPair::of(pair, corners_a, corners_b);
            match found.distance <= max_distance {
                true => visitor(found),
                false => ControlFlow::Continue(()),
            }
        };
        let (scale, are_collapsed) = (placements.a_from_b_scale(), placements.are_collapsed());
        let Self {
            stack,
            leaves_a,
            leaves_b,
            collapsed,
            stats,
        } = self;
        *stats = QueryStats::default();
        if are_collapsed {
            collapsed.place(a, b);
            let _stopped_early = collapsed.near(limit, stats, measure);
        } else {
            leaves_a.begin();
            leaves_b.begin();
            let bound = |a: &Aabb, b: &Aabb| squared_gap(&frames, &Box64::of(a), &Box64::of(b));
            let at_leaves = |a: &mut Posed<'_>, b: &mut Posed<'_>, of_a, of_b| {
                let (block_a, block_b) = (leaves_a.read(a, of_a), leaves_b.read(b, of_b));
                for &(triangle_a, ref corners_a) in leaves_a.triangles(block_a) {
                    let extent_a = Extent::of_triangle(corners_a);
                    for &(triangle_b, ref corners_b) in leaves_b.triangles(block_b.clone()) {
                        if extent_a.squared_distance(&Extent::of_triangle(corners_b)) <= limit {
                            stats.triangle_tests += 1;
                            measure(TrianglePair { triangle_a, triangle_b }, corners_a, corners_b)?;
                        }
                    }
                }
                ControlFlow::Continue(limit)
            };
            stats.node_tests = walk_nearest((&mut *a, &mut *b), scale, stack, limit, bound, at_leaves);
        }
        *stats += QueryStats::blending(before, [a.blended(), b.blended()]);
        Ok(())
    }
}
