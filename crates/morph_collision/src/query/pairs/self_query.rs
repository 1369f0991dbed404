//! The query for intersecting triangles of one body.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::patch_cache::{Patches, Side, intersecting_neighbours, intersecting_pairs_within};
use crate::pose::Pose;
use crate::query::capped::Capped;
use crate::query::stats::QueryStats;
use crate::query::triangle_pair::TrianglePair;
use crate::query::two_bodies::Neighbourhood;
use crate::traverse::{SelfStack, walk_within};

/// Finds the triangles of one posed mesh that intersect each other. Keep the query and use it again: it reuses its memory.
///
/// Two triangles intersect if they share a point but no vertex. Triangles with a common edge or vertex always touch, so they are
/// skipped, even if they also cross elsewhere. Vertices are compared after welding, so seams do not matter.
///
/// The answer is exact for the posed vertices in model space, so it does not depend on the body's placement. (The vertices of a skinned
/// mesh are in world space, where its joints place them.)
///
/// If the tree has certificates ([`MorphBvh::set_certificates`](crate::MorphBvh::set_certificates)), pairs that are proved free for the
/// pose's weights are not looked at. The answer is the same.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvh, MorphModel, Pose, SelfQuery};
/// // Two separate triangles. The target pushes the second one through the first.
/// let base = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z + Vec3::X, Vec3::Z * 2.0];
/// let push = [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::NEG_Z * 1.5, Vec3::NEG_Z * 1.5, Vec3::NEG_Z * 1.5];
/// let model = MorphModel::from_displacements(&base, &[[0, 1, 2], [3, 4, 5]], &[push])?;
/// let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// let mut query = SelfQuery::new();
/// assert!(!query.any(&mut pose));
/// pose.set_weights(&[1.0])?;
/// assert!(query.any(&mut pose));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct SelfQuery {
    stack: SelfStack,
    leaves: Patches,
    stats: QueryStats,
}

query_basics!(SelfQuery, |query| query.stats);

impl SelfQuery {
    /// Appends every pair of intersecting triangles, the smaller index first, in the order of the walk.
    pub fn all(&mut self, pose: &mut Pose, pairs: &mut Vec<TrianglePair>) {
        self.up_to(pose, usize::MAX, pairs);
    }

    /// Appends the first `limit` pairs of [`SelfQuery::all`]; returns whether there are more.
    ///
    /// Use it if weights may collapse the mesh to a point: all its triangles then intersect.
    pub fn up_to(&mut self, pose: &mut Pose, limit: usize, pairs: &mut Vec<TrianglePair>) -> bool {
        let mut listed = Capped::new(pairs, limit);
        self.visit(pose, |pair| listed.push(pair));
        listed.is_truncated
    }

    /// Returns whether any triangles intersect.
    pub fn any(&mut self, pose: &mut Pose) -> bool {
        self.up_to(pose, 0, &mut Vec::new())
    }

    /// Calls `visitor` for every pair of intersecting triangles, the smaller index first, until it breaks.
    pub fn visit(&mut self, pose: &mut Pose, mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>) {
        let bvh = Arc::clone(pose.bvh());
        let front = bvh.self_front_for(pose.weights());
        let Self { stack, leaves, stats } = self;
        *stats = QueryStats::default();
        if front.is_empty() {
            return;
        }
        let posed = &mut pose.posed();
        let before = posed.blended();
        let (bounds, world_from_model) = (posed.bounds(), posed.world_from_model);
        let size = world_from_model.scale() * f64::from(bounds.size().max_element());
        leaves.begin(
            &Neighbourhood::new(world_from_model.transform_point(bounds.center()), size),
            world_from_model,
        );
        let mut ordered = |TrianglePair { triangle_a, triangle_b }| {
            visitor(TrianglePair {
                triangle_a: triangle_a.min(triangle_b),
                triangle_b: triangle_a.max(triangle_b),
            })
        };
        let of_neighbours =
            intersecting_neighbours(&mut Side::new(posed, leaves), &front.neighbours, stats, &mut ordered);
        if of_neighbours.is_continue() {
            let node_tests = walk_within(posed, &front.apart, stack, u64::MAX, |posed, a, b| {
                let mut body = Side::new(posed, leaves);
                intersecting_pairs_within(&mut body, [a, b], !front.is_complete, stats, &mut ordered)
            });
            stats.node_tests = node_tests;
        }
        *stats += QueryStats::blending([before], [posed.blended()]);
    }
}
