//! Why a mesh is refused.

use thiserror::Error;

/// Why a mesh cannot become a [`MorphModel`](crate::MorphModel).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The base has no vertices.
    #[error("the mesh has no vertices")]
    NoVertices,
    /// The mesh has no triangles.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// There are more vertices, triangles, targets, joints or influences than supported.
    #[error("the mesh has {count} {what}, at most {limit} are supported")]
    TooMany {
        /// "vertices", "triangles", "targets", "joints" or "influences".
        what: &'static str,
        /// The number of them.
        count: usize,
        /// The largest number allowed.
        limit: usize,
    },
    /// A triangle has a vertex index that is out of range.
    #[error(
        "triangle {triangle}, corner {corner}: vertex index {index} is out of range, the mesh has {vertices} vertices"
    )]
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// 0, 1 or 2.
        corner: usize,
        /// The vertex index.
        index: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// An influence names a joint that does not exist.
    #[error("vertex {vertex}, influence {slot}: joint {joint} is out of range, the skin has {joint_count} joints")]
    JointOutOfRange {
        /// The vertex.
        vertex: usize,
        /// The influence, counted over all sets.
        slot: usize,
        /// The joint.
        joint: u16,
        /// The number of joints.
        joint_count: usize,
    },
    /// The weight of an influence is NaN, infinite, negative or more than 1000.
    #[error(
        "vertex {vertex}, influence {slot}: the weight of joint {joint} is {weight}, not a number between 0 and 1000"
    )]
    BadInfluence {
        /// The vertex.
        vertex: usize,
        /// The influence, counted over all sets.
        slot: usize,
        /// The joint.
        joint: u16,
        /// Its weight.
        weight: f32,
    },
    /// The joint weights of a vertex sum to more than 8000.
    #[error("vertex {vertex}: its joint weights sum to {sum}, at most 8000 are supported")]
    WeightsTooLarge {
        /// The vertex.
        vertex: usize,
        /// The sum of its weights.
        sum: f64,
    },
    /// The length of a target or a set of influences differs from the base's.
    #[error("{shape} has {length} vertices, the base has {expected}")]
    LengthMismatch {
        /// The name and index of the list, such as "target 3" or "weights of influences 0".
        shape: String,
        /// Its length.
        length: usize,
        /// The length of the base.
        expected: usize,
    },
    /// A coordinate is NaN, infinite, or larger than 1e37 in absolute value.
    #[error("{shape}, vertex {vertex}: coordinate {value} is not a number between -1e37 and 1e37")]
    BadCoordinate {
        /// "base", or "target" and its index, such as "target 3".
        shape: String,
        /// The vertex.
        vertex: usize,
        /// The coordinate.
        value: f32,
    },
}
