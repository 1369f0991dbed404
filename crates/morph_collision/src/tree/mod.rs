//! The immutable tree: which triangles are together, and a blendable volume per node.
//!
//! `partition` decides the topology on one shape, `extents` measures every node over all targets, `tables` turns extents
//! into what a pose blends, and `build` puts them together in preorder.

mod build;
mod bvh;
mod extents;
mod options;
mod partition;
mod tables;

pub use bvh::MorphBvh;
pub(crate) use bvh::{Child, ChildKind, Leaf};
pub use options::{BuildError, BuildOptions};
pub(crate) use tables::{GroupTables, Tables};
