//! Log messages about meshes.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use tracing::error;

use super::mesh_data::ImportError;
use crate::collider::MorphCollider;
use crate::names::Names;
use crate::shape::MorphShape;

/// Colliders that show a mesh, including disabled ones.
type ShowsMesh = (With<MorphCollider>, Without<MorphShape>, Allow<Disabled>);

/// What messages about meshes need.
#[derive(SystemParam)]
pub(crate) struct Complaints<'w, 's> {
    pub(super) names: Names<'w, 's>,
    colliders: Query<'w, 's, (Entity, &'static Mesh3d), ShowsMesh>,
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
        let (mesh, entity) = (self.mesh(id), self.names.entity(collider.unwrap_or(asked_by)));
        error!("{mesh} of entity `{entity}` cannot {fails}: {error}; {outcome}");
    }

    /// The mesh, with its file and label if it was loaded.
    pub(super) fn mesh(&self, id: AssetId<Mesh>) -> String {
        self.names
            .asset(id)
            .map_or_else(|| "the mesh".into(), |path| format!("mesh `{path}`"))
    }
}
