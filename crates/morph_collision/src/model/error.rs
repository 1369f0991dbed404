use std::fmt;

use thiserror::Error;

/// Which set of vectors an error speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The base positions, or reference 0.
    Base,
    /// The displacements of a target, counted from 0.
    Target(usize),
    /// The positions of a reference, counted from 0.
    Reference(usize),
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Base => write!(f, "base"),
            Self::Target(k) => write!(f, "target {k}"),
            Self::Reference(k) => write!(f, "reference {k}"),
        }
    }
}

/// Why a mesh cannot become a [`MorphModel`](crate::MorphModel).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// There is no reference to take the base positions from.
    #[error("no reference shape was given")]
    NoReferences,
    /// The base has no vertices.
    #[error("the mesh has no vertices")]
    NoVertices,
    /// The mesh has no triangles.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// More vertices, triangles or targets than can be counted.
    #[error("the mesh has {count} {what}, at most {limit} are supported")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error(
        "triangle {triangle}, corner {corner}: vertex index {index} is out of range, the mesh has {vertices} vertices"
    )]
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// 0, 1 or 2.
        corner: usize,
        /// The index it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A target or reference has another length than the base.
    #[error("{subject} has {length} vertices, the base has {expected}")]
    LengthMismatch {
        /// The target or reference.
        subject: Subject,
        /// Its length.
        length: usize,
        /// The length of the base.
        expected: usize,
    },
    /// A coordinate is NaN, infinite, or larger than 1e37.
    #[error("{subject}, vertex {vertex}: coordinate {value} is not a number between -1e37 and 1e37")]
    BadCoordinate {
        /// Base, target or reference.
        subject: Subject,
        /// The vertex.
        vertex: usize,
        /// The offending coordinate.
        value: f32,
    },
}
