//! From Bevy's [`Mesh`] to a shared tree: read on the main thread, build in the background, hand out.

mod mesh_data;
mod trees;

pub use mesh_data::ImportError;
pub use trees::MorphTrees;
pub(crate) use trees::{finish_trees, follow_asset_events, hand_out_trees, request_trees};
