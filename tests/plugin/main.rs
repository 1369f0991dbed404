//! The whole plugin in a Bevy app without a window.

mod bodies;
mod broken_meshes;
mod dolphins;
mod events;
mod log;
mod refits;
mod support;
mod trees;
mod weights;
