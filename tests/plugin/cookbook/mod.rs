//! Runs the programs in the plugin's `examples/` without a window, and checks what a player would
//! see.

mod boss;
mod faces;
mod hats;
mod loading;
mod mouths;
mod programs;

use std::path::PathBuf;

use bevy::input::InputPlugin;
use bevy::mesh::morph::MorphWeights;
use bevy::pbr::StandardMaterial;
use bevy::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::app::{update_until, without_collisions};

use crate::log::start;
use crate::support::assets;

/// A headless program before its first frame, at 60 frames a second.
fn program(plugins: impl PluginGroup, game: fn(&mut App)) -> App {
    let mut app = without_collisions(&assets());
    app.add_plugins((InputPlugin, plugins, game))
        .init_asset::<StandardMaterial>();
    start(&mut app);
    app
}

/// Runs frames until a condition holds, for five minutes at most.
fn play_until(app: &mut App, mut done: impl FnMut(&mut World) -> bool) {
    update_until(app, &head_file(), |world| Ok(done(world))).expect("it gets there");
}

fn head_file() -> PathBuf {
    assets().join("mh_head_eyes_teeth_arkit52.glb")
}

/// The head that most of the programs show, from its file.
fn head() -> MorphMesh {
    read_meshes(&head_file())
        .expect("the head comes with the repository")
        .remove(0)
}

/// The weights that the head is drawn with.
fn weights(app: &mut App) -> Vec<f32> {
    let mut nodes = app.world_mut().query::<&MorphWeights>();
    nodes.single(app.world()).expect("there is one head").weights().to_vec()
}
