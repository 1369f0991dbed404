//! Who is a collider of which body, and which tree it uses.
//!
//! - `scene`, `scene_part`: make the meshes of a [`MorphColliderScene`](crate::components::MorphColliderScene) its parts.
//! - `every_mesh`, `automatic`: make every mesh that deforms a collider. `body_roots`: finds its body.
//! - `given`: components that the plugin gives, and that stay the user's once the user changes them.
//! - `hierarchy`: entities above and below others.
//! - `users`: colliders request trees and receive them. `trees_plugin`: the systems that build trees.
//! - `readiness`: events of colliders and scenes that are ready or have failed.
//! - `spawned_scenes`, `scene_state`, `open_scenes`, `scene_outcomes`: scenes from files that get no colliders.
//! - `needs`: the plugins of Bevy that are missing.

mod automatic;
mod body_roots;
mod every_mesh;
mod given;
mod hierarchy;
mod needs;
mod open_scenes;
mod readiness;
mod scene;
mod scene_outcomes;
mod scene_part;
mod scene_state;
#[cfg(feature = "gltf")]
mod spawned_scenes;
#[cfg(not(feature = "gltf"))]
#[path = "no_spawned_scenes.rs"]
mod spawned_scenes;
mod trees_plugin;
mod users;

use bevy::prelude::*;

pub(crate) use every_mesh::update_every_deforming_mesh;
pub(crate) use hierarchy::Hierarchy;
pub(crate) use needs::check_transforms;
pub(crate) use readiness::report_readiness;
pub use readiness::{MorphColliderFailed, MorphColliderReady, MorphColliderSceneReady};
pub(crate) use scene::update_scene_parts;
pub(crate) use scene_outcomes::{any_is_open, report_outcomes};
pub use scene_part::ScenePart;
pub(crate) use scene_state::SceneState;
pub(crate) use spawned_scenes::SpawnedScenes;
pub(crate) use trees_plugin::TreesPlugin;
pub(crate) use users::{Culls, TreeUser, hand_out_trees, request_trees};

/// Adds what waits for scenes, and the events of what is ready.
pub(crate) fn add(app: &mut App) {
    app.init_resource::<open_scenes::OpenScenes>()
        .add_observer(scene::forget_scene)
        .register_type::<MorphColliderReady>()
        .register_type::<MorphColliderFailed>()
        .register_type::<MorphColliderSceneReady>();
    #[cfg(feature = "gltf")]
    app.add_observer(scene_outcomes::open_again);
}
