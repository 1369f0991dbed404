//! Why a tree cannot be restored from its layout.

use thiserror::Error;

/// The version of [`TreeLayout`](crate::TreeLayout) that this crate writes and reads.
pub(super) const VERSION: u32 = 3;

/// Why a [`TreeLayout`](crate::TreeLayout) does not fit a mesh.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// The layout was written by another version of this crate.
    #[error("tree layout has version {found}, this is version {VERSION}")]
    Version {
        /// The layout's version.
        found: u32,
    },
    /// The layout was written for another mesh.
    #[error("tree layout is of another mesh: its fingerprint is {found:016x}, the mesh's is {expected:016x}")]
    OtherMesh {
        /// The layout's fingerprint.
        found: u64,
        /// The mesh's fingerprint.
        expected: u64,
    },
    /// The layout has fewer or more triangles than the mesh.
    #[error("tree layout: {found} triangles, the mesh has {expected}")]
    TriangleCount {
        /// The number of triangles in the layout.
        found: usize,
        /// The number of triangles of the mesh.
        expected: usize,
    },
    /// A triangle is out of range or listed twice.
    #[error("tree layout: entry {entry} of the triangles is {triangle}, which is out of range or there twice")]
    Triangle {
        /// Index into the layout's triangles.
        entry: usize,
        /// The triangle there.
        triangle: u32,
    },
    /// The nodes are not a tree over the triangles.
    #[error("tree layout: the nodes are no tree over the triangles at entry {entry}")]
    Nodes {
        /// Index into the layout's nodes.
        entry: usize,
    },
    /// The certificates are corrupt.
    #[error("tree layout: certificates: {what}")]
    Certificates {
        /// What is wrong with them.
        what: &'static str,
    },
}
