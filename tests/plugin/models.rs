//! Loaded models with culling, collision and clips.

use std::path::{Path, PathBuf};

use bevy::camera::visibility::VisibilityPlugin;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::crowd;
pub(crate) use morph_collision_workspace::crowd::{NamedClip, play};

use crate::log::start;
use crate::support::settle;

/// A model from outside the repository, if that folder is there.
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/models")
        .join(name);
    if !path.is_file() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    path.canonicalize().ok()
}

/// An app with a model at several places, with culling and collision; the roots of its scenes, and the model's clips.
pub(crate) fn with_models(file: &Path, places: &[Transform]) -> (App, Vec<Entity>, Vec<NamedClip>) {
    let mut app = headless(file.parent().unwrap());
    app.add_plugins((VisibilityPlugin, MorphBoundsPlugin));
    start(&mut app);
    let parts = MorphColliderScene::default();
    let (roots, clips) = crowd::spawn(&mut app, file, places, parts).expect("the model can be loaded");
    settle(&mut app);
    (app, roots, clips)
}
