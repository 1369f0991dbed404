//! What messages call entities and assets.

use bevy::asset::{LoadState, UntypedAssetId};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// Names for messages.
#[derive(SystemParam)]
pub(crate) struct Names<'w, 's> {
    entities: Query<'w, 's, NameOrEntity, Allow<Disabled>>,
    meshes: Query<'w, 's, &'static Mesh3d, Allow<Disabled>>,
    #[cfg(feature = "gltf")]
    scenes: Query<'w, 's, &'static WorldAssetRoot, Allow<Disabled>>,
    assets: Option<Res<'w, AssetServer>>,
}

impl Names<'_, '_> {
    /// The entity's name, or its ID.
    pub(crate) fn entity(&self, entity: Entity) -> String {
        match self.entities.get(entity) {
            Ok(name) => name.to_string(),
            Err(_) => entity.to_string(),
        }
    }

    /// The entity's own name.
    pub(crate) fn own_name(&self, entity: Entity) -> Option<&str> {
        Some(self.entities.get(entity).ok()?.name?.as_str())
    }

    /// The entity, with the file of the mesh that it shows or of the scene that it spawns:
    /// `` `Head` (`face.glb#Mesh0/Primitive0`) ``.
    pub(crate) fn with_file(&self, entity: Entity) -> String {
        let name = self.entity(entity);
        match self.file(entity) {
            Some(path) => format!("`{name}` (`{path}`)"),
            None => format!("`{name}`"),
        }
    }

    /// What distinguishes an entity from others with the same mistake: its file, or else its name.
    pub(crate) fn about(&self, entity: Entity) -> String {
        let name = || self.own_name(entity).map(str::to_owned);
        self.file(entity).or_else(name).unwrap_or_default()
    }

    /// The file and label of the mesh that an entity shows, otherwise of the scene that it spawns.
    pub(crate) fn file(&self, entity: Entity) -> Option<String> {
        if let Ok(mesh) = self.meshes.get(entity) {
            return self.asset(mesh.id());
        }
        #[cfg(feature = "gltf")]
        if let Ok(scene) = self.scenes.get(entity) {
            return self.asset(scene.id());
        }
        None
    }

    /// The file and label of an asset; `None` if it was not loaded.
    pub(crate) fn asset(&self, id: impl Into<UntypedAssetId>) -> Option<String> {
        Some(self.assets.as_ref()?.get_path(id)?.to_string())
    }

    /// Whether Bevy is loading an asset.
    pub(crate) fn is_loading(&self, id: impl Into<UntypedAssetId>) -> bool {
        let state = self.assets.as_ref().map(|assets| assets.load_state(id));
        matches!(state, Some(LoadState::Loading))
    }

    /// Why Bevy could not load an asset.
    pub(crate) fn load_error(&self, id: impl Into<UntypedAssetId>) -> Option<String> {
        let (assets, id) = (self.assets.as_ref()?, id.into());
        let LoadState::Failed(error) = assets.load_state(id) else {
            return None;
        };
        // A backtrace may follow.
        let mut reason = error.to_string().lines().next().unwrap_or_default().to_owned();
        if let Some(path) = assets.get_path(id).filter(|path| path.label().is_none())
            && path.path().extension().is_some_and(|is| is == "glb" || is == "gltf")
        {
            reason += &format!(". To load a part of a glTF file, name it: `{path}#Scene0`, `{path}#Mesh0/Primitive0`");
        }
        Some(reason)
    }
}
