//! Likely mistakes are logged once, with the entity, the file and the remedy.

mod anchors;
mod colliders;
mod files;
mod physics;
mod plugins;
mod scenes;

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy::world_serialization::WorldAsset;
use morph_collision_models::gltf::write::{Appearance, to_glb};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::app::{headless, update_until};

use crate::log::{Errors, start};
use crate::support::{Edits, cube, stretching_cube};

/// Frames until everything that an entity may lack at first counts as missing.
const PATIENCE: usize = 310;

/// Runs a test's body with an app whose asset folder is given, and everything it logs.
fn with_app(assets: &Path, body: impl FnOnce(&mut App, &Errors)) {
    Errors::collect(|errors| {
        let mut app = headless(assets);
        start(&mut app);
        body(&mut app, errors);
    });
}

fn run(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}

/// The only warning that an app logs while it runs for some seconds; no errors.
fn only_warning(app: &mut App, errors: &Errors) -> String {
    run(app, PATIENCE);
    let warnings = errors.take_warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    run(app, PATIENCE);
    assert_eq!((errors.take_warnings(), errors.take()), (vec![], vec![]), "once");
    warnings.into_iter().next().unwrap()
}

/// The only warning about a world.
fn warning_about(spawn: impl FnOnce(&mut App)) -> String {
    let mut warning = None;
    with_app(Path::new("."), |app, errors| {
        spawn(app);
        warning = Some(only_warning(app, errors));
    });
    warning.unwrap()
}

/// Nothing is logged about a world.
fn is_fine(spawn: impl FnOnce(&mut App)) {
    with_app(Path::new("."), |app, errors| {
        spawn(app);
        run(app, 2 * PATIENCE);
        assert_eq!((errors.take_warnings(), errors.take()), (vec![], vec![]));
    });
}

/// Checks that a message says all of this.
fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "`{message}` does not say `{part}`");
    }
}

/// A folder with a file that morphs, a file of two rigid meshes, and a broken file.
fn files() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, mesh: &MorphMesh| {
        let bytes = to_glb(mesh, &Appearance::default()).unwrap();
        std::fs::write(folder.path().join(name), bytes).unwrap();
    };
    write("morphs.glb", &stretching_cube());
    let mut rigid = cube();
    rigid.primitives = vec![0..5, 5..12];
    write("rigid.glb", &rigid);
    std::fs::write(folder.path().join("broken.glb"), b"this is no model").unwrap();
    let path = folder.path().to_owned();
    (folder, path)
}

/// Spawns the scene of a file.
fn spawn_scene(app: &mut App, file: &str, more: impl Bundle) -> Entity {
    let scene: Handle<WorldAsset> = app.world().resource::<AssetServer>().load(file.to_owned());
    let name = Name::new("Boss");
    app.spawn((WorldAssetRoot(scene), name, more))
}

/// Runs frames until a scene or its file is loaded or has failed.
fn load(app: &mut App, root: Entity) {
    let scene = app.world().get::<WorldAssetRoot>(root).unwrap().id();
    update_until(app, Path::new("a scene"), |world| {
        let state = world.resource::<AssetServer>().load_state(scene);
        Ok(state.is_loaded() || state.is_failed())
    })
    .unwrap();
    run(app, 2);
}
