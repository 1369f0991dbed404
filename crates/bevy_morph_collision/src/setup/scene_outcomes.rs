//! Scenes from files that will have no colliders: they could not be loaded, or none of their meshes is a part.
//!
//! The events of their parts would never come, so whoever waits for the scene is told here.

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;

use super::hierarchy::Hierarchy;
use super::open_scenes::OpenScenes;
use super::readiness::{MorphColliderFailed, MorphColliderSceneReady};
use super::scene_part::ScenePart;
use super::scene_state::SceneState;
use crate::app::{Names, Suspects};
use crate::setup::SpawnedScenes;

/// A scene is open again if it, or an entity below it, gets a file.
#[cfg(feature = "gltf")]
pub(crate) fn open_again(inserted: On<Insert<WorldAssetRoot>>, hierarchy: Hierarchy, mut open: ResMut<OpenScenes>) {
    if let Some(scene) = hierarchy.scene_root(inserted.entity) {
        open.open(scene);
    }
}

/// Whether the outcome of a scene is not known yet.
pub(crate) fn any_is_open(open: Res<OpenScenes>) -> bool {
    !open.0.is_empty()
}

/// Reports the outcome of scenes without colliders. Runs only until the outcome of every scene is known.
pub(crate) fn report_outcomes(
    mut open: ResMut<OpenScenes>,
    mut suspects: ResMut<Suspects>,
    hierarchy: Hierarchy,
    parts: Query<&ScenePart, Allow<Disabled>>,
    spawned: SpawnedScenes,
    names: Names,
    mut commands: Commands,
) {
    let mut settled: Vec<(Entity, SceneState)> = Vec::new();
    open.0.retain(|&root| {
        // Nobody knows when a scene is complete that a game builds by hand.
        let state = spawned.state(root, &hierarchy, &names);
        let is_pending = state == Some(SceneState::Pending);
        settled.extend(state.filter(|_| !is_pending).map(|state| (root, state)));
        is_pending
    });
    if settled.is_empty() {
        return;
    }
    let with_parts: EntityHashSet = parts.iter().map(|part| part.root).collect();
    settled.sort_unstable_by_key(|(root, _)| *root);
    for (entity, state) in settled {
        if let SceneState::Failed(reason) = state {
            suspects.log().error("scene not loaded", reason.to_string(), || {
                let name = names.with_file(entity);
                format!("the scene of entity {name} gets no colliders: {reason}")
            });
            commands.trigger(MorphColliderFailed { entity, reason });
        } else {
            suspects.note(entity);
        }
        if !with_parts.contains(&entity) {
            commands.trigger(MorphColliderSceneReady {
                entity,
                parts: 0,
                failed: 0,
            });
        }
    }
}
