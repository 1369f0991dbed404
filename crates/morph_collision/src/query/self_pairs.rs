use std::ops::ControlFlow;

use super::capped::Capped;
use super::leaves::Leaves;
use super::{QueryStats, TrianglePair};
use crate::bounds::WorldFromModel;
use crate::exact::triangles_intersect_counting;
use crate::pose::{Pose, Posed};
use crate::traverse::{SelfStack, walk_within};

/// Asks which triangles of one posed mesh intersect each other; holds the memory that queries reuse.
///
/// Two triangles count when they share a point but no vertex: neighbours along an edge or around a vertex always touch,
/// and are left out even where they also cross elsewhere. Vertices are welded ones, so a seam in the mesh's own vertices does not
/// make neighbours collide. The answer is exact over the posed `f32` vertices in model space, which makes it independent of
/// where the body stands.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvh, MorphModel, Pose, SelfQuery};
/// // Two triangles apart; the target pushes the second through the first.
/// let base = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z + Vec3::X, Vec3::Z * 2.0];
/// let push = [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::NEG_Z * 1.5, Vec3::NEG_Z * 1.5, Vec3::NEG_Z * 1.5];
/// let model = MorphModel::from_displacements(&base, &[[0, 1, 2], [3, 4, 5]], &[push])?;
/// let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// let mut query = SelfQuery::new();
/// assert!(!query.any(&mut pose).0);
/// pose.set_weights(&[1.0])?;
/// assert!(query.any(&mut pose).0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct SelfQuery {
    stack: SelfStack,
    leaves: Leaves,
}

impl SelfQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends every pair of intersecting triangles, the smaller number first, in the order of the walk.
    pub fn all(&mut self, pose: &mut Pose, pairs: &mut Vec<TrianglePair>) -> QueryStats {
        self.visit(pose, |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        })
    }

    /// Appends at most `limit` pairs of intersecting triangles, the first ones of [`SelfQuery::all`]; says whether there are
    /// more. A mesh whose weights collapse it to a point does not list the square of its triangles.
    pub fn up_to(&mut self, limit: usize, pose: &mut Pose, pairs: &mut Vec<TrianglePair>) -> (bool, QueryStats) {
        let mut listed = Capped::new(pairs, limit);
        let stats = self.visit(pose, |pair| listed.push(pair));
        (listed.is_truncated, stats)
    }

    /// Whether any triangles intersect.
    pub fn any(&mut self, pose: &mut Pose) -> (bool, QueryStats) {
        let mut any = false;
        let stats = self.visit(pose, |_| {
            any = true;
            ControlFlow::Break(())
        });
        (any, stats)
    }

    /// Calls `visitor` for every pair of intersecting triangles, the smaller number first, until it breaks.
    ///
    /// Boxes and vertices that the query looks at are blended into the pose's cache.
    pub fn visit(&mut self, pose: &mut Pose, mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>) -> QueryStats {
        self.walk(&mut pose.posed(), &mut visitor)
    }

    fn walk(&mut self, posed: &mut Posed<'_>, visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>) -> QueryStats {
        let before = posed.blended();
        let mut stats = QueryStats::default();
        let Self { stack, leaves } = self;
        leaves.begin(posed.topology.leaf_count());
        stats.node_tests = walk_within(posed, stack, |posed, a, b| {
            // In model space, where the shape alone decides.
            let [block_a, block_b] = [a, b].map(|leaf| leaves.read(posed, &WorldFromModel::IDENTITY, leaf));
            let vertices = |number: u32| posed.model.corners(number);
            for (i, &(number_a, ref corners_a)) in leaves.triangles(block_a).iter().enumerate() {
                let others = leaves.triangles(block_b.clone());
                let others = if a == b { &others[i + 1..] } else { others };
                let vertices_a = vertices(number_a);
                for &(number_b, ref corners_b) in others {
                    if vertices_a.iter().any(|vertex| vertices(number_b).contains(vertex)) {
                        continue;
                    }
                    stats.triangle_tests += 1;
                    if triangles_intersect_counting(corners_a, corners_b, &mut stats.undecided_by_filter) {
                        visitor(TrianglePair {
                            triangle_a: number_a.min(number_b),
                            triangle_b: number_a.max(number_b),
                        })?;
                    }
                }
            }
            ControlFlow::Continue(())
        });
        let after = posed.blended();
        stats += QueryStats::blending([before], [after]);
        stats
    }
}
