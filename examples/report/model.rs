//! Models on disk, and apps that run on one thread.

use std::path::{Path, PathBuf};

use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::moments::find_real_model;

/// A model and its meshes as stored in the file.
pub(crate) struct Model {
    pub(crate) file: PathBuf,
    pub(crate) meshes: Vec<MorphMesh>,
}

impl Model {
    /// Finds a model in `assets/`, or in the folder of models beside the repository.
    pub(crate) fn find(name: &str) -> Result<Self, String> {
        let file = find_real_model(name).map_err(|missing| missing.to_string())?;
        let file = file.canonicalize().map_err(|error| format!("{name}: {error}"))?;
        let meshes = read_meshes(&file).map_err(|error| error.to_string())?;
        Ok(Self { file, meshes })
    }

    /// The folder of the file.
    pub(crate) fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new("."))
    }
}

/// Runs the systems of an app on one thread.
pub(crate) fn run_on_one_thread(app: &mut App) {
    for (_, schedule) in app.world_mut().resource_mut::<Schedules>().iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
}
