//! From Bevy's [`Mesh`] to a shared tree: read on the main thread, build in the background, hand out.

mod mesh_data;
mod tree_settings;
mod trees;

pub use mesh_data::ImportError;
pub(crate) use mesh_data::triangle_corners;
pub use tree_settings::{MorphTreeOptions, MorphTreeSettings, MorphVolume};
pub use trees::MorphTrees;
pub(crate) use trees::{TreeKey, finish_trees, follow_asset_events, hand_out_trees, request_trees, start_trees};
