//! The whole plugin in a Bevy app without a window.

mod anchors;
mod bodies;
mod bounds;
mod broken_meshes;
mod dolphins;
mod drawn;
mod events;
mod log;
mod manners;
mod pairs;
mod picking;
mod real_models;
mod refits;
mod shapes;
mod spatial;
mod support;
mod trees;
mod weights;
