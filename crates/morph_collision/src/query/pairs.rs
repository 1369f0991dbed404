use std::ops::{AddAssign, ControlFlow};

use super::body::{Body, world_triangle};
use crate::bounds::culls_of;
use crate::exact::{Triangle, triangles_intersect};
use crate::traverse::{PairWalk, Stack};

/// Two intersecting triangles, each by its number in its own mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrianglePair {
    /// A triangle of the first body.
    pub triangle_a: u32,
    /// A triangle of the second body.
    pub triangle_b: u32,
}

/// What a query had to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PairStats {
    /// Boxes tested against boxes.
    pub node_tests: u64,
    /// Pairs of triangles given to the exact test.
    pub triangle_tests: u64,
    /// Boxes blended; ones already blended for these weights are not counted again.
    pub volumes_blended: u64,
    /// Vertices blended, likewise.
    pub vertices_blended: u64,
}

impl AddAssign for PairStats {
    fn add_assign(&mut self, other: Self) {
        self.node_tests += other.node_tests;
        self.triangle_tests += other.triangle_tests;
        self.volumes_blended += other.volumes_blended;
        self.vertices_blended += other.vertices_blended;
    }
}

/// Asks which triangles of two bodies intersect; holds the memory that queries reuse.
///
/// The answer is exact over the posed vertices in world space, see the crate's introduction; touching counts. It does not
/// depend on the tree, and the same triangles come out whichever body is named first.
#[derive(Debug, Default)]
pub struct PairQuery {
    stack: Stack,
    triangles_b: Vec<Triangle>,
}

impl PairQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends every pair of intersecting triangles, in the order of the walk.
    pub fn all(&mut self, a: Body<'_>, b: Body<'_>, pairs: &mut Vec<TrianglePair>) -> PairStats {
        self.visit(a, b, |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        })
    }

    /// The first pair of intersecting triangles that the walk comes to.
    pub fn first(&mut self, a: Body<'_>, b: Body<'_>) -> (Option<TrianglePair>, PairStats) {
        let mut first = None;
        let stats = self.visit(a, b, |pair| {
            first = Some(pair);
            ControlFlow::Break(())
        });
        (first, stats)
    }

    /// Whether any triangles intersect.
    pub fn any(&mut self, a: Body<'_>, b: Body<'_>) -> (bool, PairStats) {
        let (first, stats) = self.first(a, b);
        (first.is_some(), stats)
    }

    /// Calls `visitor` for every pair of intersecting triangles, in the order of the walk, until it breaks.
    pub fn visit(
        &mut self,
        a: Body<'_>,
        b: Body<'_>,
        mut visitor: impl FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> PairStats {
        let before = [a.pose.blended(), b.pose.blended()];
        let (world_from_a, world_from_b) = (a.world_from_model, b.world_from_model);
        let culls = culls_of(world_from_a, &a.pose.bounds(), world_from_b, &b.pose.bounds());
        let mut walk = PairWalk {
            a: a.pose,
            b: b.pose,
            culls: &culls,
            a_from_b_scale: (world_from_b.scale() / world_from_a.scale()) as f32,
            node_tests: 0,
        };
        let mut triangle_tests = 0;
        let triangles_b = &mut self.triangles_b;
        let _stopped_early = walk.run(&mut self.stack, |walk, leaf_a, leaf_b| {
            let bvh_a = walk.a.bvh().clone();
            let bvh_b = walk.b.bvh().clone();
            let ids_b = bvh_b.leaf_triangles(leaf_b);
            triangles_b.clear();
            triangles_b.extend(ids_b.iter().map(|&t| world_triangle(walk.b, world_from_b, t)));
            for &triangle_a in bvh_a.leaf_triangles(leaf_a) {
                let corners_a = world_triangle(walk.a, world_from_a, triangle_a);
                for (&triangle_b, corners_b) in ids_b.iter().zip(&*triangles_b) {
                    triangle_tests += 1;
                    if triangles_intersect(&corners_a, corners_b) {
                        visitor(TrianglePair { triangle_a, triangle_b })?;
                    }
                }
            }
            ControlFlow::Continue(())
        });
        let after = [walk.a.blended(), walk.b.blended()];
        PairStats {
            node_tests: walk.node_tests,
            triangle_tests,
            volumes_blended: after[0].volumes + after[1].volumes - before[0].volumes - before[1].volumes,
            vertices_blended: after[0].vertices + after[1].vertices - before[0].vertices - before[1].vertices,
        }
    }
}
