//! The two pairs of features, and what contact means as signs of polynomials in the time.

use super::moving::MovingPoint;

/// A vertex and a face, or two edges.
///
/// Both are described by three moving vectors `u`, `v`, `w`, with the normal `n = u x v`. A vertex `p` and the face `a b c` have
/// `u = b - a`, `v = c - a`, `w = p - a`. The edges `a b` and `c d` have `u = b - a`, `v = d - c`, `w = c - a`.
///
/// Take a time at which `n` is not zero. The features touch if and only if `w` is in the plane of `u` and `v`, that is
/// `n . w = 0`, and its two parameters there are in range. The numbers `p = (w x v) . n` and `q = (u x w) . n` are the parameters times
/// `n . n`: for a face, `w = (p u + q v) / (n . n)`, so contact means `p >= 0`, `q >= 0` and `p + q <= n . n`. For edges,
/// `w = (p u + q v) / (n . n)` as well, and the edges meet at `a + s u = c + r v` with `s = p / (n . n)` and `r = -q / (n . n)`. So
/// contact means that `p` and `-q` are from 0 to `n . n`.
///
/// At a time at which `n` is zero, the face is a segment or a point, so it is the union of its three edges. The edges are parallel or
/// points, and then they touch only if an end of one is on the other. Both are contacts of a vertex with an edge (see
/// [`vertex_edges`](Self::vertex_edges)).
///
/// A point `p` is on the closed segment `a b` if and only if `(a - p) x (b - p) = 0` and `(a - p) . (b - p) <= 0`. This includes
/// segments that are points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The corners are the vertex and the three corners of the face.
    VertexFace,
    /// The corners are the two ends of one edge and the two of the other.
    EdgeEdge,
}

impl Kind {
    /// Four numbers that are positive, or at least 0, if `n` is not zero and the parameters are inside, or in range. One is negative
    /// if `n` is not zero and they are out of range. From `n . n`, `p` and `q`.
    #[inline(always)]
    pub(super) fn sides(self, normal: f64, p: f64, q: f64) -> [f64; 4] {
        match self {
            Self::VertexFace => [p, q, normal - p - q, normal],
            Self::EdgeEdge => [p, normal - p, -q, normal + q],
        }
    }

    /// The corners whose differences, second minus first, are `u`, `v` and `w`.
    #[inline(always)]
    pub(super) const fn spans(self) -> [[usize; 2]; 3] {
        match self {
            Self::VertexFace => [[1, 2], [1, 3], [1, 0]],
            Self::EdgeEdge => [[0, 1], [2, 3], [0, 2]],
        }
    }

    /// All pairs of a corner of one feature and one of the other.
    #[inline(always)]
    pub(super) const fn opposite(self) -> &'static [[usize; 2]] {
        match self {
            Self::VertexFace => &[[0, 1], [0, 2], [0, 3]],
            Self::EdgeEdge => &[[0, 2], [0, 3], [1, 2], [1, 3]],
        }
    }

    /// A vertex and the two ends of an edge, for each contact of a vertex with an edge.
    pub(super) const fn vertex_edges(self) -> &'static [[usize; 3]] {
        match self {
            Self::VertexFace => &[[0, 1, 2], [0, 2, 3], [0, 3, 1]],
            Self::EdgeEdge => &[[0, 2, 3], [1, 2, 3], [2, 0, 1], [3, 0, 1]],
        }
    }
}

/// Two features: their kind and their four corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FeaturePair {
    pub(crate) kind: Kind,
    pub(crate) corners: [MovingPoint; 4],
}
