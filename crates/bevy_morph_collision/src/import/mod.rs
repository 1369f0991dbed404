//! Turns Bevy's `Mesh` into a shared tree: copies it on the main thread, builds in the background, hands out the result.
//!
//! - `trees`: [`MorphTrees`], all trees and the systems that build them. `tree_key`: what they depend on. `mesh_tree`: one of them.
//! - `mesh_data`, `copy`: the copy of a mesh, made in parts. `decode`, `skin_data`, `triangles`: how Bevy stores its positions, joints and
//!   indices.
//! - `hull`: convex hulls of meshes.
//! - `saved`: trees that were saved in files, and are restored instead of built.
//! - `turns`: shares the time of a frame among tasks. `progress`: how far all trees are.
//! - `error`, `left_out`, `load_failures`, `complaints`: what is wrong with a mesh, and what is logged about it.
//! - `gltf`, `influence_sets`: repairs meshes without normals in Bevy's glTF loader, and notes joints that Bevy does not draw.

mod complaints;
mod copy;
mod decode;
mod error;
#[cfg(feature = "gltf")]
mod gltf;
mod hull;
#[cfg(feature = "gltf")]
mod influence_sets;
mod left_out;
mod load_failures;
mod mesh_data;
mod mesh_tree;
mod progress;
mod saved;
mod skin_data;
mod tree_key;
mod trees;
mod triangles;
mod turns;

pub(crate) use complaints::{FurtherInfluences, LoggedErrors};
pub(crate) use decode::uv_of;
pub use error::ImportError;
#[cfg(feature = "gltf")]
pub(crate) use gltf::repair_split_meshes;
pub use left_out::MorphLeftOut;
pub(crate) use load_failures::{LoadFailures, any_may_fail, update_load_failures};
pub use progress::MorphTreeProgress;
pub use saved::{MorphTreeFile, MorphTreeFileError, MorphTreeFilesPlugin, MorphTreeFrom};
pub(crate) use skin_data::influences_of;
pub(crate) use tree_key::TreeKey;
pub use trees::MorphTrees;
pub(crate) use trees::{apply_asset_events, finish_trees, start_trees};
