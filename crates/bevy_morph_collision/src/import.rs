//! From Bevy's [`Mesh`] to a shared tree: copied on the main thread, built in the background, handed out.

mod complaints;
#[cfg(feature = "gltf")]
mod gltf;
mod mesh_data;
mod mesh_tree;
mod skin_data;
mod tree_key;
mod tree_settings;
mod trees;
mod users;

#[cfg(feature = "gltf")]
pub(crate) use gltf::repair_split_meshes;
pub use mesh_data::ImportError;
pub(crate) use skin_data::influences_of;
pub(crate) use tree_key::TreeKey;
pub use tree_settings::{MorphTreeOptions, MorphTreeSettings};
pub use trees::MorphTrees;
pub(crate) use trees::{finish_trees, follow_asset_events, start_trees};
pub(crate) use users::{Culls, drop_unused_trees, hand_out_trees, request_trees};
