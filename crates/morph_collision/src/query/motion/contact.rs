use crate::TrianglePair;
use crate::exact::motion::TimeOfImpact;

/// What touches: a vertex and a face, or two edges. Vertices are welded vertices ([`Body::vertex`](crate::Body::vertex)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Features {
    /// A vertex of the first body touches a triangle of the second.
    VertexFace {
        /// The vertex of the first body.
        vertex_a: u32,
        /// The triangle of the second body.
        triangle_b: u32,
    },
    /// A triangle of the first body touches a vertex of the second.
    FaceVertex {
        /// The triangle of the first body.
        triangle_a: u32,
        /// The vertex of the second body.
        vertex_b: u32,
    },
    /// Two edges touch.
    EdgeEdge {
        /// The ends of the first body's edge, the smaller number first.
        edge_a: [u32; 2],
        /// The ends of the second body's edge, the smaller number first.
        edge_b: [u32; 2],
    },
    /// Two triangles that intersect when the motion starts. Only [`MotionQuery::first`](super::MotionQuery::first) reports it.
    AtStart(TrianglePair),
}

/// A contact during a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionContact {
    /// What touches.
    pub features: Features,
    /// When it first touches, as a share of the motion.
    pub time: TimeOfImpact,
}
