use std::ops::{AddAssign, Sub};

use crate::pose::Blended;

/// What a query had to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryStats {
    /// Boxes tested against boxes, or against what was asked about.
    pub node_tests: u64,
    /// Triangles, or pairs of triangles, given to the exact test.
    pub triangle_tests: u64,
    /// Pairs of triangles among them whose boxes overlap and that the error-bounded filter left to the exact predicates.
    pub undecided_by_filter: u64,
    /// Boxes blended; ones already blended for these weights are not counted again.
    pub volumes_blended: u64,
    /// Vertices blended: those of each leaf that the query reads, every time; where leaves are blended vertex by vertex (few triangles
    /// in a leaf, or many targets), only those that were not yet blended for these weights.
    pub vertices_blended: u64,
}

impl QueryStats {
    /// What was blended on each of some bodies between two readings.
    pub(super) fn blending<const N: usize>(before: [Blended; N], after: [Blended; N]) -> Self {
        let mut stats = Self::default();
        for (before, after) in before.into_iter().zip(after) {
            stats.volumes_blended += after.volumes - before.volumes;
            stats.vertices_blended += after.vertices - before.vertices;
        }
        stats
    }
}

impl AddAssign for QueryStats {
    fn add_assign(&mut self, other: Self) {
        self.node_tests += other.node_tests;
        self.triangle_tests += other.triangle_tests;
        self.undecided_by_filter += other.undecided_by_filter;
        self.volumes_blended += other.volumes_blended;
        self.vertices_blended += other.vertices_blended;
    }
}

/// What was done between two readings of a running total.
impl Sub for QueryStats {
    type Output = Self;

    fn sub(self, earlier: Self) -> Self {
        Self {
            node_tests: self.node_tests - earlier.node_tests,
            triangle_tests: self.triangle_tests - earlier.triangle_tests,
            undecided_by_filter: self.undecided_by_filter - earlier.undecided_by_filter,
            volumes_blended: self.volumes_blended - earlier.volumes_blended,
            vertices_blended: self.vertices_blended - earlier.vertices_blended,
        }
    }
}
