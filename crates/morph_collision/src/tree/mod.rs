//! The immutable tree: which triangles are together, and what blends into a box for each node.
//!
//! `partition` (with `sah`) decides the `topology` on the base and the targets, `extents` measures every node on each of them,
//! `tables` turns extents into what a pose blends, `leaf_lanes` lays out the leaves' triangles for the exact tests, and `build`
//! puts all of it together in preorder.

mod build;
mod bvh;
mod extents;
mod layout;
mod leaf_lanes;
mod options;
mod partition;
mod sah;
mod stats;
mod subtrees;
mod tables;
mod topology;

pub use bvh::MorphBvh;
pub use layout::{LayoutError, TreeLayout};
pub(crate) use leaf_lanes::{CornerLanes, LeafLanes, PatchColumns, in_lanes, put};
pub use options::{BuildError, BuildOptions};
pub use stats::{BrokenTree, BvhStats};
pub(crate) use tables::{GroupTables, Tables};
pub(crate) use topology::{Child, ChildKind, Leaf, Topology};

#[cfg(test)]
mod sah_tests;
#[cfg(test)]
mod tests;
