//! A vertex and a face, or two edges, that move linearly.

/// The position of a point at time 0 and at time 1. Coordinates must be finite.
pub type PointMotion = [[f64; 3]; 2];

/// Which features move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MotionKind {
    /// A vertex and a face.
    VertexFace,
    /// Two edges.
    EdgeEdge,
}

impl MotionKind {
    /// Both kinds.
    pub const ALL: [Self; 2] = [Self::VertexFace, Self::EdgeEdge];

    /// A name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::VertexFace => "vertex-face",
            Self::EdgeEdge => "edge-edge",
        }
    }
}

/// The smallest problem of continuous collision detection: four points that move linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementaryMotion {
    /// Which features the points are.
    pub kind: MotionKind,
    /// The vertex and the three corners of the face; or the two ends of one edge and then those of the other.
    pub points: [PointMotion; 4],
}

impl ElementaryMotion {
    /// The same motion backwards in time: contact at time `t` becomes contact at `1 - t`.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        for [start, end] in &mut self.points {
            std::mem::swap(start, end);
        }
        self
    }

    /// The same motion with its points listed in another order: all orders of a face's corners, or all orders of the edges and
    /// their ends. They have the same answer. The first is `self`.
    #[must_use]
    pub fn reordered(&self) -> Vec<Self> {
        let orders: &[[usize; 4]] = match self.kind {
            MotionKind::VertexFace => &[
                [0, 1, 2, 3],
                [0, 2, 3, 1],
                [0, 3, 1, 2],
                [0, 1, 3, 2],
                [0, 3, 2, 1],
                [0, 2, 1, 3],
            ],
            MotionKind::EdgeEdge => &[
                [0, 1, 2, 3],
                [1, 0, 2, 3],
                [0, 1, 3, 2],
                [1, 0, 3, 2],
                [2, 3, 0, 1],
                [3, 2, 0, 1],
                [2, 3, 1, 0],
                [3, 2, 1, 0],
            ],
        };
        let reorder = |order: &[usize; 4]| Self {
            kind: self.kind,
            points: order.map(|point| self.points[point]),
        };
        orders.iter().map(reorder).collect()
    }

    /// Whether all coordinates are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.points.as_flattened().as_flattened().iter().all(|x| x.is_finite())
    }
}
