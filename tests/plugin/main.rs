//! The whole plugin in a Bevy app without a window.

mod actors;
mod adding;
mod anchors;
mod bodies;
mod body_events;
mod bounds;
mod broken_meshes;
mod changes;
mod collapsed;
mod combinations;
mod compressed;
mod continuous;
#[cfg(feature = "render")]
mod cookbook;
mod copying;
mod costs;
mod dolphins;
mod drawn;
mod editors;
mod events;
mod files;
mod group;
mod head;
mod hooks;
mod integration;
mod levels;
mod life_cycle;
mod live;
mod log;

mod mistakes;
mod models;
mod netcode;
mod noticed;
mod pairs;
#[cfg(feature = "diagnostic_ui")]
mod panel;
mod picking;
mod readiness;
mod real_models;
mod refits;
mod reflection;
mod rollback;
mod scenes;
mod self_collisions;
mod shapes;
mod skins;
mod spatial;
mod support;
mod tolerance;
mod tree_files;
mod trees;
mod velocities;
mod weights;
