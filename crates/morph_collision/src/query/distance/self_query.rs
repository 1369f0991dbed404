//! The query for triangles of one body that are close to each other.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::closest_pair::ClosestPair;
use super::search::Search;
use super::within::Within;
use crate::bounds::Extent;
use crate::exact::Triangle;
use crate::input_error::{InputError, check_length};
use crate::model::MorphModel;
use crate::pose::{Pose, Posed};
use crate::query::leaves::Leaves;
use crate::query::rank::MARGIN;
use crate::query::stats::QueryStats;
use crate::query::triangle_pair::TrianglePair;
use crate::traverse::{SelfStack, walk_near};
use crate::tree::Leaf;

/// Finds the triangles of one posed mesh that come close to each other. Keep the query and use it again: it reuses its memory.
///
/// As for [`SelfQuery`](crate::SelfQuery), triangles that share a vertex after welding are skipped, and distances are measured in model
/// space, for a skinned mesh in world space. Triangles near a vertex are close to its next neighbours, so choose a distance below the
/// lengths of the mesh's edges.
///
/// ```
/// # use std::ops::ControlFlow;
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvh, MorphModel, Pose, SelfDistanceQuery};
/// // Two separate triangles, one above the other.
/// let base = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z + Vec3::X, Vec3::Z + Vec3::Y];
/// let model = MorphModel::from_displacements::<[Vec3; 0]>(&base, &[[0, 1, 2], [3, 4, 5]], &[])?;
/// let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// let mut found = Vec::new();
/// SelfDistanceQuery::new().within(&mut pose, 2.0, |pair| {
///     found.push((pair.triangles.triangle_a, pair.triangles.triangle_b, pair.distance));
///     ControlFlow::Continue(())
/// })?;
/// assert_eq!(found, [(0, 1, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct SelfDistanceQuery {
    stack: SelfStack,
    leaves: Leaves,
    stats: QueryStats,
}

query_basics!(SelfDistanceQuery, |query| query.stats);

impl SelfDistanceQuery {
    /// Calls `visitor` for every pair of triangles at most `max_distance` apart, the smaller index first, until it breaks. Pairs that
    /// intersect have a distance of 0.
    ///
    /// The pairs do not depend on the tree, except those whose distance equals `max_distance` up to rounding. Their order does. Let the
    /// visitor break after as many pairs as you have room for: all pairs of a mesh may be this close.
    ///
    /// # Errors
    /// [`InputError`] if `max_distance` is negative or NaN.
    pub fn within(
        &mut self,
        pose: &mut Pose,
        max_distance: f64,
        visitor: impl FnMut(ClosestPair) -> ControlFlow<()>,
    ) -> Result<(), InputError> {
        check_length("max_distance", max_distance)?;
        let bvh = Arc::clone(pose.bvh());
        let front = bvh.self_front();
        let Self { stack, leaves, stats } = self;
        *stats = QueryStats::default();
        leaves.begin();
        let posed = &mut pose.posed();
        let before = posed.blended();
        let mut within = Within::new(max_distance, visitor);
        let mut tests = 0;
        let mut at_leaves = |posed: &mut Posed<'_>, a: Leaf, b: Leaf| {
            let (block_a, block_b) = (leaves.read(posed, a), leaves.read(posed, b));
            let of_b = leaves.triangles(block_b);
            for (i, of_a) in leaves.triangles(block_a).iter().enumerate() {
                let others = if a == b { &of_b[i + 1..] } else { of_b };
                tests += close(posed.model, of_a, others, &mut within)?;
            }
            ControlFlow::Continue(())
        };
        // Every pair of adjacent leaves has its first patches in the list.
        let mut adjacent = front.neighbours.iter().filter(|pair| pair.patches == [0; 2]);
        let of_neighbours = adjacent.try_for_each(|pair| {
            let [a, b] = pair.leaves();
            at_leaves(posed, a, b)
        });
        if of_neighbours.is_continue() {
            let enlarged = |bounds| Extent::around(&bounds, max_distance * MARGIN).outward();
            stats.node_tests = walk_near(posed, &front.apart, stack, u64::MAX, enlarged, at_leaves);
        }
        stats.triangle_tests = tests;
        *stats += QueryStats::blending([before], [posed.blended()]);
        Ok(())
    }
}

/// Measures a triangle's distances to others that share no vertex with it and whose boxes are close enough. Returns how many were measured.
fn close<V: FnMut(ClosestPair) -> ControlFlow<()>>(
    model: &MorphModel,
    &(triangle, ref corners): &(u32, Triangle),
    others: &[(u32, Triangle)],
    within: &mut Within<V>,
) -> ControlFlow<(), u64> {
    let (extent, vertices, limit) = (Extent::of_triangle(corners), model.corners(triangle), within.limit());
    let mut tests = 0;
    for &(other, ref other_corners) in others {
        let is_far = extent.squared_distance(&Extent::of_triangle(other_corners)) > limit;
        if is_far || model.corners(other).iter().any(|vertex| vertices.contains(vertex)) {
            continue;
        }
        tests += 1;
        let in_order = |triangle_a, triangle_b| TrianglePair { triangle_a, triangle_b };
        match triangle < other {
            true => within.measure(in_order(triangle, other), corners, other_corners),
            false => within.measure(in_order(other, triangle), other_corners, corners),
        }?;
    }
    ControlFlow::Continue(tests)
}
