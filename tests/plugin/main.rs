//! The whole plugin in a Bevy app without a window.

mod anchors;
mod bodies;
mod bounds;
mod broken_meshes;
mod changes;
mod collapsed;
mod dolphins;
mod drawn;
mod events;
mod files;
mod life_cycle;
mod log;
mod manners;
mod models;
mod pairs;
mod picking;
mod real_models;
mod refits;
mod scenes;
mod shapes;
mod skins;
mod spatial;
mod support;
mod trees;
mod velocities;
mod weights;
