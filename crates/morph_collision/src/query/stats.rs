use std::ops::AddAssign;

/// What a query had to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct QueryStats {
    /// Volumes tested against volumes, or against what was asked about.
    pub node_tests: u64,
    /// Triangles, or pairs of triangles, given to the exact test.
    pub triangle_tests: u64,
    /// Volumes blended; ones already blended for these weights are not counted again.
    pub volumes_blended: u64,
    /// Vertices blended, likewise.
    pub vertices_blended: u64,
}

impl AddAssign for QueryStats {
    fn add_assign(&mut self, other: Self) {
        self.node_tests += other.node_tests;
        self.triangle_tests += other.triangle_tests;
        self.volumes_blended += other.volumes_blended;
        self.vertices_blended += other.vertices_blended;
    }
}
