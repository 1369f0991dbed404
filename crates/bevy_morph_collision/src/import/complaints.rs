//! Log messages about meshes, and the names that they use for meshes and entities.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use tracing::error;

use super::mesh_data::ImportError;
use crate::collider::MorphCollider;
use crate::shape::MorphShape;

/// Colliders that show a mesh, including disabled ones.
type ShowsMesh = (With<MorphCollider>, Without<MorphShape>, Allow<Disabled>);

/// Names for messages.
#[derive(SystemParam)]
pub(crate) struct Complaints<'w, 's> {
    names: Query<'w, 's, NameOrEntity, Allow<Disabled>>,
    colliders: Query<'w, 's, (Entity, &'static Mesh3d), ShowsMesh>,
    assets: Option<Res<'w, AssetServer>>,
}

impl Complaints<'_, '_> {
    /// Logs why a mesh cannot be used, which entity requested its tree, and what happens instead.
    pub(super) fn unusable_mesh(
        &self,
        id: AssetId<Mesh>,
        asked_by: Entity,
        has_last_good_tree: bool,
        error: &ImportError,
    ) {
        // The requesting entity may only need culling.
        let is_collider = |entity: Entity| self.colliders.get(entity).is_ok_and(|(_, mesh)| mesh.id() == id);
        let any_collider = || Some(self.colliders.iter().find(|(_, mesh)| mesh.id() == id)?.0);
        let collider = Some(asked_by)
            .filter(|&entity| is_collider(entity))
            .or_else(any_collider);
        let (fails, outcome) = match collider {
            Some(_) if has_last_good_tree => ("collide", "its last good shape stays in force"),
            Some(_) => ("collide", "colliders that show it are left out"),
            None => (
                "be culled by its morphed bounds",
                "it keeps the bounds that it has, those of the rest pose at first",
            ),
        };
        let (mesh, entity) = (self.mesh(id), self.entity(collider.unwrap_or(asked_by)));
        error!("mesh `{mesh}` of entity `{entity}` cannot {fails}: {error}; {outcome}");
    }

    /// The mesh's file and label, or its asset ID.
    pub(super) fn mesh(&self, id: AssetId<Mesh>) -> String {
        let path = self.assets.as_ref().and_then(|assets| assets.get_path(id));
        path.map_or_else(|| id.to_string(), |path| path.to_string())
    }

    /// The entity's name, or its ID.
    pub(super) fn entity(&self, entity: Entity) -> String {
        match self.names.get(entity) {
            Ok(name) => name.to_string(),
            Err(_) => entity.to_string(),
        }
    }
}
