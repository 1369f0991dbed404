//! Without the feature `gltf`, no entity spawns a scene that the plugin knows.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

use super::hierarchy::Hierarchy;
use super::scene_state::SceneState;
use crate::app::Names;

/// As in `spawned_scenes.rs`.
#[derive(SystemParam)]
pub(crate) struct SpawnedScenes<'w, 's> {
    _roots: Query<'w, 's, ()>,
}

impl SpawnedScenes<'_, '_> {
    pub(crate) fn is_root(&self, _: Entity) -> bool {
        false
    }

    pub(crate) fn is_pending(&self, _: Entity, _: &Names) -> bool {
        false
    }

    pub(crate) fn state(&self, _: Entity, _: &Hierarchy, _: &Names) -> Option<SceneState> {
        None
    }

    pub(crate) fn any_is_pending(&self, _: &Names) -> bool {
        false
    }
}
