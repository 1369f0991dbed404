//! The immutable tree: which triangles each node holds, and the numbers that a pose blends into the node's box.
//!
//! - `build` runs all stages; `builder` runs them in steps, and `budget` decides where a step ends.
//! - `layout` and `certificate_layout` are what is stored of a tree, and `tree_file` stores the layouts of a model's meshes in one file.
//! - `sah` splits a node's triangles by the surface-area heuristic.
//! - `topology` records the nodes in preorder.
//! - `extents` measures the base and each target over every node.
//! - `tables` turns extents into the numbers that a pose blends.
//! - `leaf_lanes` stores the corners of the leaves' triangles for the exact tests.
//! - `owners` gives each vertex and edge to one triangle, when a query about motion first needs it.
//! - `adjacency` lists the leaves that share vertices, and `self_front` the other pairs of nodes at which a walk over the tree and itself
//!   starts, when such a walk first needs them.
//!
//! For skinned meshes:
//!
//! - `skin_tables` is stored instead of `tables`.
//! - `chunks` cuts the tree into subtrees that are posed as a whole, with boxes fitted to their vertices.
//! - `outer_tables` bounds the nodes above them by the vertices that each joint moves.
//! - `joint_boxes` bounds the vertices that each joint moves in the whole mesh.
//! - `part_tables` has the boxes of both: finished where no target moves them, and otherwise the numbers that a pose blends.

mod adjacency;
mod budget;
mod build;
mod builder;
mod bvh;
mod certificate_layout;
mod certificates;
mod chunks;
mod extents;
mod joint_boxes;
mod layout;
mod layout_error;
mod leaf_lanes;
mod options;
mod outer_tables;
mod owners;
mod part_tables;
mod sah;
mod self_front;
mod skin_tables;
mod tables;
mod topology;
#[cfg(feature = "tree-file")]
mod tree_file;

pub(crate) use adjacency::{PatchPair, unrelated};
pub use builder::MorphBvhBuilder;
pub use bvh::MorphBvh;
pub use certificates::SelfCertificates;
pub(crate) use certificates::{Area, OpenPairs};
pub(crate) use chunks::Source;
pub(crate) use joint_boxes::JointBoxes;
pub use layout::TreeLayout;
pub use layout_error::LayoutError;
pub(crate) use leaf_lanes::{CornerLanes, LeafLanes, PatchColumns, gather, gather_from};
#[cfg(test)]
pub(crate) use leaf_lanes::{in_lanes, put};
pub use options::BuildOptions;
pub(crate) use outer_tables::{OuterGroup, OuterTables};
pub(crate) use owners::{Owned, Owners};
pub(crate) use part_tables::{PartBlocks, PartTables};
pub(crate) use self_front::{Apart, SelfFront};
pub(crate) use skin_tables::SkinTables;
pub(crate) use tables::{GroupTables, Tables};
pub(crate) use topology::{Child, ChildKind, Leaf, NodeId, Topology};
#[cfg(feature = "tree-file")]
pub use tree_file::{SavedTree, TreeFile, TreeFileError};

#[cfg(test)]
mod builder_tests;
#[cfg(test)]
mod chunk_tests;
#[cfg(test)]
mod sah_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod validate_tests;
