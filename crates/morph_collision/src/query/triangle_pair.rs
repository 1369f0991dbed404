//! A pair of triangles, the answer of most queries about two bodies.

/// A pair of triangles, each as an index into its own mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TrianglePair {
    /// The triangle of the first body.
    pub triangle_a: u32,
    /// The triangle of the second body.
    pub triangle_b: u32,
}
