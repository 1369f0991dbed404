//! Counts of the work of a query.

use std::ops::{Add, AddAssign, Sub};

use crate::pose::Blended;

/// The work that a query did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryStats {
    /// Node bounds tested against another node's bounds, or against the query's shape.
    pub node_tests: u64,
    /// Triangles, or pairs of triangles, tested.
    pub triangle_tests: u64,
    /// Triangle pairs with overlapping boxes that filters in `f64` could not decide, so that exact arithmetic was needed.
    pub undecided_by_filter: u64,
    /// Pairs of a vertex and a face, or of two edges, tested by a [`MotionQuery`](crate::motion::MotionQuery). For a ball, the intervals of
    /// time for which it and a triangle were compared.
    pub feature_tests: u64,
    /// Those of them that are degenerate or touch at the start or at the end, and were decided there by exact signs, a few microseconds
    /// each.
    pub feature_tests_at_ends: u64,
    /// Those of them that needed exact polynomials, tens of microseconds each.
    pub exact_feature_tests: u64,
    /// The sum of the bits of their coordinates ([`StageCounts::exact_bits`](crate::motion::StageCounts::exact_bits)).
    pub exact_bits: u64,
    /// Nodes whose bounds were blended. Bounds that are cached for the current weights are not blended again.
    pub nodes_blended: u64,
    /// Vertices blended. A leaf blends all its vertices each time a query reads it. Pairs that the `f32` filter cannot decide blend
    /// theirs once more. In trees whose leaves are blended vertex by vertex (many targets), vertices that are cached for the current
    /// weights are not blended again.
    pub vertices_blended: u64,
}

impl QueryStats {
    /// The numbers of bounds and vertices blended between two readings of each body's counters.
    pub(super) fn blending<const N: usize>(before: [Blended; N], after: [Blended; N]) -> Self {
        let readings = before.into_iter().zip(after);
        readings.fold(Self::default(), |sum, (before, after)| Self {
            nodes_blended: sum.nodes_blended + after.volumes - before.volumes,
            vertices_blended: sum.vertices_blended + after.vertices - before.vertices,
            ..sum
        })
    }

    fn zip(self, other: Self, combine: impl Fn(u64, u64) -> u64) -> Self {
        Self {
            node_tests: combine(self.node_tests, other.node_tests),
            triangle_tests: combine(self.triangle_tests, other.triangle_tests),
            feature_tests: combine(self.feature_tests, other.feature_tests),
            feature_tests_at_ends: combine(self.feature_tests_at_ends, other.feature_tests_at_ends),
            exact_feature_tests: combine(self.exact_feature_tests, other.exact_feature_tests),
            exact_bits: combine(self.exact_bits, other.exact_bits),
            undecided_by_filter: combine(self.undecided_by_filter, other.undecided_by_filter),
            nodes_blended: combine(self.nodes_blended, other.nodes_blended),
            vertices_blended: combine(self.vertices_blended, other.vertices_blended),
        }
    }
}

impl Add for QueryStats {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.zip(other, |x, y| x + y)
    }
}

impl AddAssign for QueryStats {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// The work between two readings of a running total.
impl Sub for QueryStats {
    type Output = Self;

    fn sub(self, earlier: Self) -> Self {
        self.zip(earlier, |x, y| x - y)
    }
}
