//! One tree per mesh asset, shared by all its instances.

use bevy::platform::time::Instant;
use std::sync::Arc;

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use morph_collision::{BuildOptions, MorphBvh, Pose};
use tracing::error;

use super::mesh_data::{ImportError, MeshData};
use crate::collider::{ColliderState, MorphCollider};
use crate::diagnostics::MorphCollisionDiagnostics;

/// The collision trees of all meshes that a collider has asked for.
///
/// A tree is built when the first collider with a loaded mesh asks for it, again when the mesh is modified, and dropped with
/// the mesh asset. If a modified mesh cannot be used, the tree of its last good state stays in force.
#[derive(Resource, Default)]
pub struct MorphTrees {
    options: BuildOptions,
    of_mesh: HashMap<AssetId<Mesh>, MeshTree>,
}

/// What is known of one mesh.
struct MeshTree {
    tree: Option<Arc<MorphBvh>>,
    building: Option<Task<Result<MorphBvh, ImportError>>>,
    error: Option<ImportError>,
    /// The collider that asked first, for messages.
    asked_by: Entity,
}

impl MorphTrees {
    pub(crate) fn new(options: BuildOptions) -> Self {
        Self {
            options,
            ..Self::default()
        }
    }

    /// The tree of a mesh, if one is ready.
    #[must_use]
    pub fn get(&self, mesh: AssetId<Mesh>) -> Option<&Arc<MorphBvh>> {
        self.of_mesh.get(&mesh)?.tree.as_ref()
    }

    /// Why the mesh in its current state could not be used; the error is in the log, too.
    #[must_use]
    pub fn error(&self, mesh: AssetId<Mesh>) -> Option<&ImportError> {
        self.of_mesh.get(&mesh)?.error.as_ref()
    }

    /// The trees that are ready, in no particular order.
    pub fn iter(&self) -> impl Iterator<Item = (AssetId<Mesh>, &Arc<MorphBvh>)> {
        self.of_mesh
            .iter()
            .filter_map(|(&mesh, entry)| Some((mesh, entry.tree.as_ref()?)))
    }

    /// How many trees are being built in the background right now.
    #[must_use]
    pub fn building(&self) -> usize {
        self.of_mesh.values().filter(|entry| entry.building.is_some()).count()
    }
}

impl std::fmt::Debug for MorphTrees {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphTrees")
            .field("options", &self.options)
            .field("trees", &self.iter().count())
            .field("building", &self.building())
            .finish()
    }
}

/// Modified meshes are built anew, removed ones forgotten.
pub(crate) fn follow_asset_events(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut trees: ResMut<MorphTrees>,
    meshes: Res<Assets<Mesh>>,
    complaints: Complaints,
) {
    for event in events.read() {
        match *event {
            AssetEvent::Modified { id } => {
                let trees = &mut *trees;
                if let (Some(entry), Some(mesh)) = (trees.of_mesh.get_mut(&id), meshes.get(id)) {
                    entry.start(id, mesh, &trees.options, &complaints);
                }
            }
            AssetEvent::Removed { id } | AssetEvent::Unused { id } => {
                trees.of_mesh.remove(&id);
            }
            AssetEvent::Added { .. } | AssetEvent::LoadedWithDependencies { .. } => {}
        }
    }
}

/// Meshes that a collider shows for the first time are read and their trees begun, as soon as they are loaded.
pub(crate) fn request_trees(
    colliders: Query<(Entity, &Mesh3d), With<MorphCollider>>,
    mut trees: ResMut<MorphTrees>,
    meshes: Res<Assets<Mesh>>,
    complaints: Complaints,
) {
    for (entity, mesh) in &colliders {
        let id = mesh.id();
        if trees.of_mesh.contains_key(&id) {
            continue;
        }
        let Some(mesh) = meshes.get(id) else { continue };
        let mut entry = MeshTree {
            tree: None,
            building: None,
            error: None,
            asked_by: entity,
        };
        entry.start(id, mesh, &trees.options, &complaints);
        trees.of_mesh.insert(id, entry);
    }
}

impl MeshTree {
    /// Reads the mesh and begins a tree in the background; what was being built before is dropped.
    fn start(&mut self, id: AssetId<Mesh>, mesh: &Mesh, options: &BuildOptions, complaints: &Complaints) {
        self.building = None;
        match MeshData::read(mesh) {
            Ok(data) => {
                let options = options.clone();
                let pool = AsyncComputeTaskPool::get_or_init(Default::default);
                self.building = Some(pool.spawn(async move { data.build(&options) }));
            }
            Err(error) => self.fail(id, error, complaints),
        }
    }

    fn fail(&mut self, id: AssetId<Mesh>, error: ImportError, complaints: &Complaints) {
        complaints.log(id, self, &error);
        self.error = Some(error);
    }
}

/// Trees that are done replace the ones before.
pub(crate) fn finish_trees(mut trees: ResMut<MorphTrees>, complaints: Complaints) {
    for (&id, entry) in &mut trees.of_mesh {
        let Some(result) = entry.building.as_mut().and_then(check_ready) else {
            continue;
        };
        entry.building = None;
        match result {
            Ok(tree) => {
                entry.tree = Some(Arc::new(tree));
                entry.error = None;
            }
            Err(error) => entry.fail(id, error, &complaints),
        }
    }
}

/// Colliders whose mesh or tree is another one than before get a new pose, or none while there is no tree.
pub(crate) fn hand_out_trees(
    mut colliders: Query<(Option<&Mesh3d>, &mut ColliderState), With<MorphCollider>>,
    trees: Res<MorphTrees>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    for (mesh, mut state) in &mut colliders {
        let tree = mesh.and_then(|mesh| trees.get(mesh.id()));
        let current = state.pose.as_ref().map(Pose::bvh);
        let is_current = match (tree, current) {
            (Some(tree), Some(current)) => Arc::ptr_eq(tree, current),
            (None, None) => true,
            _ => false,
        };
        if is_current {
            continue;
        }
        let mut pose = tree.map(|tree| Pose::new(tree.clone()));
        if let (Some(pose), Some(before)) = (&mut pose, &state.pose) {
            // The last good weights stay in force if the ones to come are bad; another number of targets starts at rest.
            let _fits = pose.set_weights(before.weights());
        }
        state.pose = pose;
        state.reposed = true;
        state.changed = true;
    }
    diagnostics.duration += start.elapsed();
}

/// Says in the log which mesh is unusable, who asked for it and why.
#[derive(bevy::ecs::system::SystemParam)]
pub(crate) struct Complaints<'w, 's> {
    names: Query<'w, 's, NameOrEntity>,
    assets: Option<Res<'w, AssetServer>>,
}

impl Complaints<'_, '_> {
    fn log(&self, id: AssetId<Mesh>, entry: &MeshTree, error: &ImportError) {
        let path = self.assets.as_ref().and_then(|assets| assets.get_path(id));
        let mesh = path.map_or_else(|| id.to_string(), |path| path.to_string());
        let entity = match self.names.get(entry.asked_by) {
            Ok(name) => name.to_string(),
            Err(_) => entry.asked_by.to_string(),
        };
        let outcome = if entry.tree.is_some() {
            "its last good shape stays in force"
        } else {
            "colliders that show it are left out"
        };
        error!("mesh `{mesh}` of entity `{entity}` cannot collide: {error}; {outcome}");
    }
}
