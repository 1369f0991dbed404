//! A headless Bevy app at a fixed time step, and loading a glTF model in it.

use std::path::{Path, PathBuf};
use std::time::Duration;

use bevy::animation::AnimationPlugin;
use bevy::asset::{AssetMetaCheck, AssetPath, RecursiveDependencyLoadState, UnapprovedPathMode, UntypedAssetId};
use bevy::gltf::{Gltf, GltfPlugin};
use bevy::log::LogPlugin;
use bevy::mesh::MeshPlugin;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_morph_collision::plugins::MorphCollisionPlugin;

use crate::error::ExampleError;

/// The time between two frames.
pub const STEP: Duration = Duration::from_nanos(16_666_667);

/// How long to wait for a model before giving up.
const PATIENCE: Duration = Duration::from_secs(300);

/// An app that loads assets, plays animations and detects collisions, without a window.
///
/// Asset paths are relative to the folder `assets`. You can add more plugins before you call [`ready`].
pub fn headless(assets: &Path) -> App {
    let mut app = without_collisions(assets);
    app.add_plugins(MorphCollisionPlugin);
    app
}

/// The same app without the collision plugin.
pub fn without_collisions(assets: &Path) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin {
            file_path: assets.to_string_lossy().into_owned(),
            meta_check: AssetMetaCheck::Never,
            // A user's own model may be anywhere.
            unapproved_path_mode: UnapprovedPathMode::Allow,
            ..AssetPlugin::default()
        },
        WorldSerializationPlugin,
        ImagePlugin::default(),
        MeshPlugin,
        GltfPlugin::default(),
        AnimationPlugin,
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    app
}

/// Logs errors, except about files that cannot be loaded: examples report those by name.
pub fn log() -> LogPlugin {
    LogPlugin {
        filter: "error,bevy_asset=off".into(),
        ..LogPlugin::default()
    }
}

/// Does what a runner does before the first frame. From here on, call [`App::update`].
pub fn ready(app: &mut App) {
    app.finish();
    app.cleanup();
}

/// The full path of an existing model.
///
/// # Errors
/// The file is missing or a directory, or its name is not a valid asset path.
pub fn locate(model: &Path) -> Result<PathBuf, ExampleError> {
    let path = model.canonicalize().map_err(|source| ExampleError::Open {
        path: model.into(),
        source,
    })?;
    if path.is_file() && path.to_str().is_some() {
        Ok(path)
    } else {
        Err(ExampleError::NotAFile(path))
    }
}

/// Loads a glTF file in the app's asset folder, with everything it refers to.
///
/// # Errors
/// The asset server's error if the file, or one that it refers to, cannot be read or is invalid.
pub fn load_gltf(app: &mut App, file: &Path) -> Result<Handle<Gltf>, ExampleError> {
    let handle: Handle<Gltf> = app
        .world()
        .resource::<AssetServer>()
        .load(AssetPath::from_path_buf(file.file_name().unwrap_or_default().into()));
    update_until(app, file, |world| {
        is_loaded(world.resource::<AssetServer>(), handle.id().untyped(), file)
    })?;
    Ok(handle)
}

/// Whether the asset `asset` from `file` is loaded, with everything it refers to.
///
/// # Errors
/// The asset server's error if loading failed.
pub fn is_loaded(assets: &AssetServer, asset: UntypedAssetId, file: &Path) -> Result<bool, ExampleError> {
    match assets.recursive_dependency_load_state(asset) {
        RecursiveDependencyLoadState::Loaded => Ok(true),
        RecursiveDependencyLoadState::Failed(error) => Err(ExampleError::Load {
            path: file.into(),
            reason: first_line(&error),
        }),
        RecursiveDependencyLoadState::NotLoaded | RecursiveDependencyLoadState::Loading => Ok(false),
    }
}

/// The error's message without the backtrace that follows its first line.
pub(crate) fn first_line(error: &impl ToString) -> String {
    error.to_string().lines().next().unwrap_or_default().to_owned()
}

/// Runs frames until a condition holds.
///
/// # Errors
/// Errors of the condition, and [`ExampleError::Stuck`] after five minutes.
pub fn update_until(
    app: &mut App,
    file: &Path,
    mut done: impl FnMut(&mut World) -> Result<bool, ExampleError>,
) -> Result<(), ExampleError> {
    let start = Instant::now();
    while !done(app.world_mut())? {
        if start.elapsed() > PATIENCE {
            return Err(ExampleError::Stuck {
                path: file.into(),
                seconds: PATIENCE.as_secs(),
            });
        }
        app.update();
    }
    Ok(())
}
