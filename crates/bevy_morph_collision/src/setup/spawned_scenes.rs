//! How far the scenes are that Bevy spawns from assets.

use bevy::asset::UntypedAssetId;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, QueryData};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::world_serialization::{WorldInstance, WorldInstanceSpawner};

use super::hierarchy::Hierarchy;
use super::scene_state::SceneState;
use crate::app::Names;
use crate::import::ImportError;

/// The components of an entity that spawns a scene.
#[derive(QueryData)]
pub(crate) struct Root {
    scene: Option<&'static WorldAssetRoot>,
    dynamic: Option<&'static DynamicWorldRoot>,
    instance: Option<&'static WorldInstance>,
}

/// Entities that spawn a scene.
type IsRoot = (Or<(With<WorldAssetRoot>, With<DynamicWorldRoot>)>, Allow<Disabled>);

/// The entities that spawn scenes.
#[derive(SystemParam)]
pub(crate) struct SpawnedScenes<'w, 's> {
    roots: Query<'w, 's, Root, IsRoot>,
    spawner: Option<Res<'w, WorldInstanceSpawner>>,
}

impl SpawnedScenes<'_, '_> {
    /// Whether the entity spawns a scene.
    pub(crate) fn is_root(&self, entity: Entity) -> bool {
        self.roots.contains(entity)
    }

    /// Whether the entity will spawn a scene, but has not yet.
    pub(crate) fn is_pending(&self, entity: Entity, names: &Names) -> bool {
        let root = self.roots.get(entity);
        root.is_ok_and(|root| self.state_of(root, names) == SceneState::Pending)
    }

    /// How far the files are that a [`MorphColliderScene`](crate::components::MorphColliderScene) spawns at or below its entity: pending if any of them
    /// is, otherwise failed if any has failed. `None` if there are none. Looks at every entity of the scene.
    pub(crate) fn state(&self, scene: Entity, hierarchy: &Hierarchy, names: &Names) -> Option<SceneState> {
        let mut of_all = None;
        for entity in std::iter::once(scene).chain(hierarchy.below(scene)) {
            let Ok(root) = self.roots.get(entity) else { continue };
            // A scene within a scene is a body of its own.
            if hierarchy.scene_root(entity) != Some(scene) {
                continue;
            }
            match self.state_of(root, names) {
                SceneState::Pending => return Some(SceneState::Pending),
                SceneState::Failed(error) => of_all = Some(SceneState::Failed(error)),
                SceneState::Spawned => _ = of_all.get_or_insert(SceneState::Spawned),
            }
        }
        of_all
    }

    /// Whether any scene of the app is still to be spawned.
    pub(crate) fn any_is_pending(&self, names: &Names) -> bool {
        let mut states = self.roots.iter().map(|root| self.state_of(root, names));
        states.any(|state| state == SceneState::Pending)
    }

    fn state_of(&self, root: RootItem<'_, '_>, names: &Names) -> SceneState {
        let Some(spawner) = &self.spawner else {
            let reason =
                "nobody spawns scenes. Add `WorldSerializationPlugin` to the app (`DefaultPlugins` contains it)";
            return SceneState::Failed(ImportError::NotLoaded(reason.into()));
        };
        if root
            .instance
            .is_some_and(|instance| spawner.instance_is_ready(**instance))
        {
            return SceneState::Spawned;
        }
        let scene: Option<UntypedAssetId> = root.scene.map(|scene| scene.id().untyped());
        let asset = scene.or_else(|| Some(root.dynamic?.id().untyped()));
        match asset.and_then(|asset| names.load_error(asset)) {
            Some(error) => SceneState::Failed(ImportError::NotLoaded(error)),
            None => SceneState::Pending,
        }
    }
}
