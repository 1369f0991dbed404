//! One tree per mesh asset, shared by all its instances.

use bevy::platform::time::Instant;
use std::sync::Arc;

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use morph_collision::{BuildOptions, MorphBvh, Pose};
use tracing::error;

use super::mesh_data::{ImportError, MeshData};
use super::tree_settings::{MorphTreeOptions, MorphTreeSettings};
use crate::broad_phase::Candidates;
use crate::collider::{ColliderState, MorphCollider};
use crate::diagnostics::{MorphCollisionDiagnostics, Preparation};

/// The collision trees of all meshes that a collider has asked for.
///
/// A tree is built when the first collider with a loaded mesh asks for it, again when the mesh is modified, and dropped with
/// the mesh asset. If a modified mesh cannot be used, the tree of its last good state stays in force.
#[derive(Resource, Reflect, Default)]
#[reflect(Resource, Debug, Default)]
pub struct MorphTrees {
    #[reflect(ignore)]
    of_mesh: HashMap<TreeKey, MeshTree>,
    /// Asked for, and not begun yet, because the mesh is not loaded.
    #[reflect(ignore)]
    waiting: Vec<(TreeKey, Entity)>,
    /// Another number whenever a tree came or went.
    #[reflect(ignore)]
    version: u64,
    /// Whether what colliders show has to be looked through anew.
    #[reflect(ignore)]
    stale: bool,
}

/// A mesh, and settings if it has its own.
pub(crate) type TreeKey = (AssetId<Mesh>, Option<MorphTreeSettings>);

/// What is known of one mesh.
struct MeshTree {
    tree: Option<Arc<MorphBvh>>,
    building: Option<Task<Result<MorphBvh, ImportError>>>,
    /// Whether the mesh was modified after what is being built was read.
    outdated: bool,
    error: Option<ImportError>,
    /// The collider that asked first, for messages.
    asked_by: Entity,
}

impl MorphTrees {
    /// The tree of a mesh without settings of its own, if it is ready.
    #[must_use]
    pub fn get(&self, mesh: AssetId<Mesh>) -> Option<&Arc<MorphBvh>> {
        self.with_settings(mesh, None)
    }

    /// The tree of a mesh with settings of its own, if it is ready.
    #[must_use]
    pub fn with_settings(&self, mesh: AssetId<Mesh>, settings: Option<MorphTreeSettings>) -> Option<&Arc<MorphBvh>> {
        self.of_mesh.get(&(mesh, settings))?.tree.as_ref()
    }

    /// Why the mesh in its current state could not be used; the error is in the log, too.
    #[must_use]
    pub fn error(&self, mesh: AssetId<Mesh>) -> Option<&ImportError> {
        let mut entries = self.of_mesh.iter().filter(|((of, _), _)| *of == mesh);
        entries.find_map(|(_, entry)| entry.error.as_ref())
    }

    /// The trees that are ready, in no particular order; a mesh may have several, with different settings.
    pub fn iter(&self) -> impl Iterator<Item = (AssetId<Mesh>, &Arc<MorphBvh>)> {
        self.of_mesh
            .iter()
            .filter_map(|(&(mesh, _), entry)| Some((mesh, entry.tree.as_ref()?)))
    }

    /// How many trees are being built in the background right now.
    #[must_use]
    pub fn building(&self) -> usize {
        self.of_mesh.values().filter(|entry| entry.building.is_some()).count()
    }

    /// Sees to it that a tree will be there once its mesh is loaded.
    pub(crate) fn request(&mut self, key: TreeKey, asked_by: Entity) {
        if !self.of_mesh.contains_key(&key) && !self.waiting.iter().any(|(waiting, _)| *waiting == key) {
            self.waiting.push((key, asked_by));
        }
    }

    pub(crate) fn is_stale(&self) -> bool {
        self.stale
    }

    /// The tree of a mesh as it is now, if there is one: none while a modified mesh is being built, or could not be.
    pub(crate) fn up_to_date(&self, key: TreeKey) -> Option<&Arc<MorphBvh>> {
        let entry = self.of_mesh.get(&key)?;
        let current = entry.building.is_none() && entry.error.is_none();
        entry.tree.as_ref().filter(|_| current)
    }
}

impl std::fmt::Debug for MorphTrees {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphTrees")
            .field("trees", &self.iter().count())
            .field("building", &self.building())
            .field("waiting", &self.waiting.len())
            .finish()
    }
}

/// Modified meshes are built anew, removed ones forgotten.
pub(crate) fn follow_asset_events(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut trees: ResMut<MorphTrees>,
    options: Res<MorphTreeOptions>,
    meshes: Res<Assets<Mesh>>,
    complaints: Complaints,
) {
    for event in events.read() {
        let trees = &mut *trees;
        match *event {
            AssetEvent::Modified { id } => {
                let Some(mesh) = meshes.get(id) else { continue };
                for (key, entry) in trees.of_mesh.iter_mut().filter(|((of, _), _)| *of == id) {
                    // A mesh that is modified all the time still gets trees.
                    entry.outdated = entry.building.is_some();
                    if !entry.outdated {
                        entry.start(key, mesh, &options.0, &complaints);
                    }
                }
            }
            AssetEvent::Removed { id } | AssetEvent::Unused { id } => {
                let before = trees.of_mesh.len();
                trees.of_mesh.retain(|(of, _), _| *of != id);
                trees.version += (before - trees.of_mesh.len()) as u64;
                trees.waiting.retain(|((of, _), _)| *of != id);
                // Whoever still shows it may get it back under the same name.
                trees.stale = true;
            }
            AssetEvent::Added { .. } => trees.stale = true,
            AssetEvent::LoadedWithDependencies { .. } => {}
        }
    }
}

/// What decides which tree a collider has.
type Shows = (Option<&'static Mesh3d>, Option<&'static MorphTreeSettings>);

fn key_of((mesh, settings): (Option<&Mesh3d>, Option<&MorphTreeSettings>)) -> Option<TreeKey> {
    mesh.map(|mesh| (mesh.id(), settings.copied()))
}

/// Trees that a collider has not had yet are asked for.
pub(crate) fn request_trees(
    colliders: Query<(Entity, Shows, &ColliderState), With<MorphCollider>>,
    mut trees: ResMut<MorphTrees>,
    mut preparation: ResMut<Preparation>,
) {
    let start = Instant::now();
    for (entity, shows, state) in &colliders {
        let key = key_of(shows);
        if let Some(key) = key.filter(|_| trees.stale || key != state.tree) {
            trees.request(key, entity);
        }
    }
    preparation.0 += start.elapsed();
}

/// Meshes that were asked for are read and their trees begun, as soon as they are loaded.
pub(crate) fn start_trees(
    mut trees: ResMut<MorphTrees>,
    options: Res<MorphTreeOptions>,
    meshes: Res<Assets<Mesh>>,
    complaints: Complaints,
) {
    trees.stale = false;
    if trees.waiting.is_empty() {
        return;
    }
    let MorphTrees { of_mesh, waiting, .. } = &mut *trees;
    waiting.retain(|&(key, asked_by)| {
        let Some(mesh) = meshes.get(key.0) else { return true };
        let mut entry = MeshTree {
            tree: None,
            building: None,
            outdated: false,
            error: None,
            asked_by,
        };
        entry.start(&key, mesh, &options.0, &complaints);
        of_mesh.insert(key, entry);
        false
    });
}

impl MeshTree {
    /// Reads the mesh and begins a tree in the background.
    fn start(&mut self, key: &TreeKey, mesh: &Mesh, options: &BuildOptions, complaints: &Complaints) {
        self.building = None;
        match MeshData::read(mesh) {
            Ok(data) => {
                let options = key.1.map_or_else(|| options.clone(), |settings| settings.over(options));
                let pool = AsyncComputeTaskPool::get_or_init(Default::default);
                self.building = Some(pool.spawn(async move { data.build(&options) }));
            }
            Err(error) => self.fail(key.0, error, complaints),
        }
    }

    fn fail(&mut self, id: AssetId<Mesh>, error: ImportError, complaints: &Complaints) {
        complaints.log(id, self, &error);
        self.error = Some(error);
    }
}

/// Trees that are done replace the ones before.
pub(crate) fn finish_trees(
    mut trees: ResMut<MorphTrees>,
    options: Res<MorphTreeOptions>,
    meshes: Res<Assets<Mesh>>,
    complaints: Complaints,
) {
    let MorphTrees { of_mesh, version, .. } = trees.bypass_change_detection();
    for (key, entry) in of_mesh {
        let Some(result) = entry.building.as_mut().and_then(check_ready) else {
            continue;
        };
        entry.building = None;
        *version += 1;
        match result {
            Ok(tree) => {
                entry.tree = Some(Arc::new(tree));
                entry.error = None;
            }
            Err(error) => entry.fail(key.0, error, &complaints),
        }
        if std::mem::take(&mut entry.outdated)
            && let Some(mesh) = meshes.get(key.0)
        {
            entry.start(key, mesh, &options.0, &complaints);
        }
    }
}

/// Colliders whose mesh or tree is another one than before get a new pose, or none while there is no tree.
///
/// Mesh and settings are compared by value: this may run less often than changes are remembered, and not while an entity is disabled.
pub(crate) fn hand_out_trees(
    mut colliders: Query<(Entity, Shows, &mut ColliderState), With<MorphCollider>>,
    candidates: Res<Candidates>,
    mut trees: ResMut<MorphTrees>,
    mut version: Local<u64>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let every = *version != trees.version;
    *version = trees.version;
    for (entity, shows, mut state) in &mut colliders {
        let key = key_of(shows);
        let was_away = state.seen != candidates.run();
        if !every && !was_away && state.tree == key {
            continue;
        }
        if let Some(key) = key.filter(|_| was_away) {
            trees.request(key, entity);
        }
        let tree = key.and_then(|(mesh, settings)| trees.with_settings(mesh, settings));
        state.take_tree(key, tree);
    }
    diagnostics.duration += start.elapsed();
}

impl ColliderState {
    fn take_tree(&mut self, key: Option<TreeKey>, tree: Option<&Arc<MorphBvh>>) {
        self.tree = key;
        let is_current = match (tree, self.pose.as_ref().map(Pose::bvh)) {
            (Some(tree), Some(current)) => Arc::ptr_eq(tree, current),
            (None, None) => true,
            _ => false,
        };
        if is_current {
            return;
        }
        let mut pose = tree.map(|tree| Pose::new(tree.clone()));
        if let (Some(pose), Some(before)) = (&mut pose, &self.pose) {
            // The last good weights stay in force if the ones to come are bad; another number of targets starts at rest.
            let _fits = pose.set_weights(before.weights());
        }
        self.pose = pose;
        self.reposed = true;
        self.changed = true;
    }
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
