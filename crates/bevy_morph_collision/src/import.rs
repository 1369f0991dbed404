//! From Bevy's [`Mesh`] to a shared tree: copied on the main thread, built in the background, handed out.

mod bones;
mod complaints;
#[cfg(feature = "gltf")]
mod gltf;
mod mesh_data;
mod mesh_tree;
mod tree_settings;
mod trees;
mod users;

pub(crate) use bones::warn_of_bones;
#[cfg(feature = "gltf")]
pub(crate) use gltf::repair_split_meshes;
pub use mesh_data::ImportError;
pub use tree_settings::{MorphTreeOptions, MorphTreeSettings};
pub use trees::MorphTrees;
pub(crate) use trees::{TreeKey, finish_trees, follow_asset_events, start_trees};
pub(crate) use users::{Culls, drop_unused_trees, hand_out_trees, request_trees};
