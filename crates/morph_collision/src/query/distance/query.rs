//! The query for distances of two bodies: the walk that its searches share.

use std::ops::ControlFlow;

use super::closest::Closest;
use super::closest_pair::ClosestPair;
use super::search::{LeafTriangles, Search};
use super::within::Within;
use crate::bounds::{Aabb, Box64, GapFrame};
use crate::exact::largest;
use crate::input_error::{InputError, check_length};
use crate::pose::{PlacedBody, Posed};
use crate::query::body::Body;
use crate::query::leaves::Leaves;
use crate::query::stats::QueryStats;
use crate::query::two_bodies::{Collapsed, PlacedPair};
use crate::traverse::{NearestStack, walk_nearest};

/// Finds the closest points of two bodies. Keep the query and use it again: it reuses its memory.
///
/// The distance is measured between surfaces: a body inside another one is not at distance 0. It does not depend on the trees, and
/// neither do the triangles and points if it is above 0. If triangles intersect, any intersecting pair may be returned.
///
/// There are two exceptions, in which the returned triangles may depend on the trees and the distance may be too long by a relative
/// 1e-9:
///
/// - bodies smaller than a millionth of their distance;
/// - bodies with more than 16,384 triangle pairs at the same distance up to rounding, such as two bodies flattened to parallel lines.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
/// a.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
/// let above = WorldFromModel::new(Affine3A::from_translation(Vec3::new(0.0, 0.0, 2.0)))?;
/// let bodies = (Body::new(&mut a, &WorldFromModel::IDENTITY), Body::new(&mut b, &above));
/// let closest = DistanceQuery::new().closest(bodies.0, bodies.1, f64::INFINITY)?;
/// assert_eq!(closest.map(|pair| pair.distance), Some(1.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct DistanceQuery {
    stack: NearestStack,
    leaves_a: Leaves,
    leaves_b: Leaves,
    collapsed: Collapsed,
    stats: QueryStats,
}

query_basics!(DistanceQuery, |query| query.stats);

impl DistanceQuery {
    /// Returns the closest points of two bodies; `None` if they are farther apart than `max_distance`, which may be infinite.
    ///
    /// A smaller `max_distance` means less work.
    ///
    /// # Errors
    /// [`InputError`] if `max_distance` is negative or NaN.
    pub fn closest(&mut self, a: Body<'_>, b: Body<'_>, max_distance: f64) -> Result<Option<ClosestPair>, InputError> {
        check_length("max_distance", max_distance)?;
        let closest = self.run(a, b, |with_ties| Closest::new(max_distance, with_ties));
        Ok(closest.found())
    }

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
        a: Body<'_>,
        b: Body<'_>,
        max_distance: f64,
        visitor: impl FnMut(ClosestPair) -> ControlFlow<()>,
    ) -> Result<(), InputError> {
        check_length("max_distance", max_distance)?;
        self.run(a, b, |_| Within::new(max_distance, visitor));
        Ok(())
    }

    /// Runs a search. It is created with whether distances of the bodies' triangles differ clearly.
    fn run<S: Search>(&mut self, mut a: Body<'_>, mut b: Body<'_>, new: impl FnOnce(bool) -> S) -> S {
        let (a, b) = (&mut a.posed(), &mut b.posed());
        let before = [a.blended(), b.blended()];
        let pair = PlacedPair {
            a: a.placed_body(),
            b: b.placed_body(),
        };
        let (scale, are_collapsed) = (pair.a_from_b_scale(), pair.are_collapsed());
        let (placed_a, placed_b) = (&pair.a.placed, &pair.b.placed);
        let mut frames = GapFrame::list(placed_a, placed_b);
        let are_far = are_far(&frames, &pair);
        if are_far {
            // An `f32` rotation is not quite orthogonal: at this distance, the error of lengths in the bodies' own spaces is larger
            // than the bodies.
            frames.push(GapFrame::world(placed_a, placed_b));
        }
        let mut search = new(!are_far && !are_collapsed);
        let Self {
            stack,
            leaves_a,
            leaves_b,
            collapsed,
            stats,
        } = self;
        *stats = QueryStats::default();
        if are_collapsed {
            collapsed.fill(a, b);
            search.at_collapsed(collapsed, stats);
        } else {
            leaves_a.begin();
            leaves_b.begin();
            let (limit, tests) = (search.limit(), &mut stats.triangle_tests);
            let bound = |a: &Aabb, b: &Aabb| squared_gap(&frames, &Box64::of(a), &Box64::of(b));
            let at_leaves = |a: &mut Posed<'_>, b: &mut Posed<'_>, leaf_a, leaf_b| {
                let (block_a, block_b) = (leaves_a.read(a, leaf_a), leaves_b.read(b, leaf_b));
                let a = LeafTriangles {
                    leaf: leaf_a,
                    triangles: leaves_a.triangles(block_a),
                };
                let b = LeafTriangles {
                    leaf: leaf_b,
                    triangles: leaves_b.triangles(block_b),
                };
                search.at_leaves(a, b, tests)
            };
            stats.node_tests = walk_nearest(a, b, scale, stack, limit, bound, at_leaves);
        }
        *stats += QueryStats::blending(before, [a.blended(), b.blended()]);
        search
    }
}

/// A lower bound for the squared distance between the contents of two boxes.
fn squared_gap(frames: &[GapFrame], a: &Box64, b: &Box64) -> f64 {
    let squared = |frame: &GapFrame| frame.squared(&frame.image_of_a(a), &frame.image_of_b(b));
    largest(frames.iter().map(squared))
}

/// Whether two bodies are so small compared with their distance that all their triangles are about equally close.
fn are_far(frames: &[GapFrame], pair: &PlacedPair<'_>) -> bool {
    const FAR: f64 = 1e6;
    let boxes = [pair.a, pair.b].map(|placed_body| Box64::of(&placed_body.bounds));
    let size =
        |placed_body: &PlacedBody, of: &Box64| of.half.element_sum() * placed_body.placed.world_from_model().scale();
    let far = 2.0 * FAR * (size(pair.a, &boxes[0]) + size(pair.b, &boxes[1]));
    far * far <= squared_gap(frames, &boxes[0], &boxes[1])
}
