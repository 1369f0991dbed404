//! Log messages about meshes.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use tracing::{error, warn};

use super::error::ImportError;
use super::left_out::MorphLeftOut;
use crate::app::Names;
use crate::components::{MorphCollider, MorphShape};

/// Colliders that show a mesh, including disabled ones.
type CollidesAsMesh = (With<MorphCollider>, Without<MorphShape>, Allow<Disabled>);

/// The meshes of glTF files with more joints per vertex than Bevy draws, `file.glb#Mesh0`, and whether the log says so. Loaders write it from
/// any thread.
#[derive(Resource, Clone, Default)]
pub(crate) struct FurtherInfluences(Arc<Mutex<HashMap<String, bool>>>);

impl FurtherInfluences {
    #[cfg(feature = "gltf")]
    pub(super) fn insert(&self, mesh: String) {
        self.all().insert(mesh, false);
    }

    /// Whether a primitive, `file.glb#Mesh0/Primitive1`, is of such a mesh.
    pub(crate) fn has(&self, primitive: &str) -> bool {
        self.all().contains_key(mesh_of(primitive))
    }

    fn all(&self) -> MutexGuard<'_, HashMap<String, bool>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn mesh_of(primitive: &str) -> &str {
    primitive.rsplit_once("/Primitive").map_or(primitive, |(mesh, _)| mesh)
}

/// The last message about each mesh, so that none is repeated for every entity or every try.
#[derive(Resource, Default)]
pub(crate) struct LoggedErrors(Mutex<HashMap<AssetId<Mesh>, String>>);

impl LoggedErrors {
    fn is_new(&self, id: AssetId<Mesh>, message: String) -> bool {
        let mut logged = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        logged.insert(id, message.clone()) != Some(message)
    }

    fn forget(&self, id: AssetId<Mesh>) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).remove(&id);
    }
}

/// What messages about meshes need.
#[derive(SystemParam)]
pub(crate) struct Complaints<'w, 's> {
    pub(super) names: Names<'w, 's>,
    colliders: Query<'w, 's, (Entity, &'static Mesh3d), CollidesAsMesh>,
    further: Res<'w, FurtherInfluences>,
    logged: Res<'w, LoggedErrors>,
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
        if !self.logged.is_new(id, error.to_string()) {
            return;
        }
        let collider = self.collider(id, asked_by);
        let (fails, outcome) = match collider {
            Some(_) if has_last_good_tree => ("collide", "its last good shape stays in force"),
            Some(_) => ("collide", "colliders that show it are left out"),
            None => (
                "be culled by its morphed bounds",
                "it keeps the bounds that it has, those of the rest pose at first",
            ),
        };
        let (mesh, entity) = (self.mesh(id), self.names.entity(collider.unwrap_or(asked_by)));
        let remedy = if error.is_about_a_triangle() {
            ". `MorphCollisionSettings::skip_bad_triangles` leaves out only the bad triangles"
        } else {
            ""
        };
        error!("{mesh} of entity `{entity}` cannot {fails}: {error}; {outcome}{remedy}");
    }

    /// Warns about a mesh that is used without its bad triangles.
    pub(super) fn left_out(&self, id: AssetId<Mesh>, asked_by: Entity, left_out: &MorphLeftOut) {
        let MorphLeftOut {
            triangles,
            of_triangles,
            reason,
        } = left_out;
        let told = format!("{triangles} of its {of_triangles} triangles are left out: {reason}");
        if self.logged.is_new(id, told.clone()) {
            let (mesh, entity) = (self.mesh(id), self.names.entity(asked_by));
            warn!("{mesh} of entity `{entity}` has bad triangles; {told}");
        }
    }

    /// Warns about a skinned mesh if its file has more joints per vertex than Bevy draws, once for each mesh of the file.
    pub(super) fn further_influences(&self, id: AssetId<Mesh>, asked_by: Entity) {
        let Some(path) = self.names.asset(id) else { return };
        let mesh = mesh_of(&path);
        let told = self
            .further
            .all()
            .get_mut(mesh)
            .map(|told| std::mem::replace(told, true));
        if told == Some(false) {
            let entity = self.names.entity(asked_by);
            warn!(
                "mesh `{mesh}` of entity `{entity}` has more than four joints per vertex in its file. Bevy draws the first four, and what \
                 collides is what Bevy draws; export it with at most four joints per vertex"
            );
        }
    }

    /// A mesh is usable again or gone: what was said about it may be said again.
    pub(super) fn forget(&self, id: AssetId<Mesh>) {
        self.logged.forget(id);
    }

    /// A collider that shows a mesh: the entity that requested its tree, unless that only needs culling.
    fn collider(&self, id: AssetId<Mesh>, asked_by: Entity) -> Option<Entity> {
        let is_collider = |entity: Entity| self.colliders.get(entity).is_ok_and(|(_, mesh)| mesh.id() == id);
        let any_collider = || Some(self.colliders.iter().find(|(_, mesh)| mesh.id() == id)?.0);
        Some(asked_by)
            .filter(|&entity| is_collider(entity))
            .or_else(any_collider)
    }

    /// The mesh, with its file and label if it was loaded.
    pub(super) fn mesh(&self, id: AssetId<Mesh>) -> String {
        self.names
            .asset(id)
            .map_or_else(|| "the mesh".into(), |path| format!("mesh `{path}`"))
    }
}
