//! One tree per mesh asset, shared by all instances.

use std::sync::Arc;
use std::time::Duration;

use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use bevy::tasks::futures::check_ready;
use morph_collision::MorphBvh;

use super::complaints::Complaints;
use super::error::ImportError;
use super::left_out::MorphLeftOut;
use super::mesh_tree::{Background, MeshTree, Source, Work};
use super::saved::{Saved, SavedTrees};
use super::tree_key::TreeKey;
#[cfg(feature = "gltf")]
use super::turns::Turns;
use crate::components::{MorphCollisionSettings, MorphTreeOptions};

/// The collision trees of all meshes that a collider has requested.
///
/// A tree is built when the first collider with a loaded mesh requests it, and again when the mesh is modified. If a modified
/// mesh cannot be used, the tree of its last valid state stays in use. A mesh has one tree per distinct [`MorphTreeOptions`] in
/// use, and per number of joints of the [`SkinnedMesh`] with which it is shown. An unused tree is dropped as soon as something
/// uses another tree of the same mesh. The last trees of a mesh are kept for later spawns until the mesh asset is removed.
///
/// Only systems can access Bevy's meshes, so meshes are copied on the main thread: in a frame of 1/60 s, at most 65,536 positions,
/// indices, displacements and joint influences, which takes about 0.4 ms on a server's core. A face with 30,000 vertices and 52
/// targets takes about 27 such frames. A mesh that is modified while it is being copied is copied again in one go. Everything else happens
/// in the background. The copy has no displacements that are zero, and is gone before the tree is built: with it, importing a mesh takes at most
/// about three times the memory that remains.
///
/// If tasks share the main thread, as on the web, all of them together take 4 ms of such a frame plus at most one step. A step takes
/// about a millisecond, but a mesh is checked and welded in a single step, which takes tens of milliseconds for the largest
/// faces.
///
/// If the last frame took longer than 1/60 s for other reasons, both may do more in the same proportion, up to twelve times as
/// much. So a model gets ready about as fast where frames are slow.
#[derive(Resource, Reflect, Default)]
#[reflect(Resource, Debug, Default)]
pub struct MorphTrees {
    #[reflect(ignore)]
    pub(super) of_mesh: HashMap<TreeKey, MeshTree>,
    /// Requested, but not started because the mesh is not loaded yet.
    #[reflect(ignore)]
    pub(super) waiting: Vec<(TreeKey, Entity)>,
    /// Changes whenever a tree is added or removed.
    #[reflect(ignore)]
    version: u64,
    /// Whether the meshes of all colliders have to be checked again.
    #[reflect(ignore)]
    pub(super) stale: bool,
    /// Whether colliders may show something different from when unused trees were last dropped. Set while trees are requested.
    #[reflect(ignore)]
    uses_changed: bool,
    /// How much mesh data may still be copied in this frame.
    #[reflect(ignore)]
    left: usize,
    /// What background tasks need.
    #[reflect(ignore)]
    background: Background,
}

/// The number of positions, indices, displacements and influences copied per frame of 1/60 s.
const COPIED_PER_FRAME: usize = 1 << 16;

impl MorphTrees {
    /// The tree of a mesh for entities without [`MorphTreeOptions`] and without [`SkinnedMesh`], if it is ready.
    #[must_use]
    pub fn get(&self, mesh: AssetId<Mesh>) -> Option<&Arc<MorphBvh>> {
        self.with_options(mesh, None)
    }

    /// The tree of a mesh for entities with these options and without [`SkinnedMesh`], if it is ready. While it is being built
    /// for the first time, a tree of the same mesh with other options, if there is one.
    #[must_use]
    pub fn with_options(&self, mesh: AssetId<Mesh>, options: Option<MorphTreeOptions>) -> Option<&Arc<MorphBvh>> {
        let joints = None;
        self.tree(TreeKey { mesh, options, joints })
    }

    /// The tree of a mesh for entities with these components, if it is ready.
    ///
    /// It is skinned if `skin` is given and the mesh has joint indices and weights. It then has as many joints as `skin`.
    #[must_use]
    pub fn shown_with(
        &self,
        mesh: &Mesh3d,
        options: Option<&MorphTreeOptions>,
        skin: Option<&SkinnedMesh>,
    ) -> Option<&Arc<MorphBvh>> {
        self.tree(TreeKey::of(mesh, options, skin))
    }

    /// Shares the time of frames with tasks.
    #[cfg(feature = "gltf")]
    pub(super) fn turns(&self) -> Turns {
        self.background.turns.clone()
    }

    /// The tree with a key, if it is ready.
    pub(crate) fn tree(&self, key: TreeKey) -> Option<&Arc<MorphBvh>> {
        self.of_mesh.get(&key)?.tree.as_ref()
    }

    /// Why the current state of the mesh cannot be used. The error is also logged.
    #[must_use]
    pub fn error(&self, mesh: AssetId<Mesh>) -> Option<&ImportError> {
        let mut entries = self.of_mesh.iter().filter(|(key, _)| key.mesh == mesh);
        entries.find_map(|(_, entry)| entry.error.as_ref())
    }

    /// What the trees of a mesh lack because it is bad; `None` if they have all triangles.
    ///
    /// Bad triangles are only left out with [`MorphCollisionSettings::skip_bad_triangles`].
    #[must_use]
    pub fn left_out(&self, mesh: AssetId<Mesh>) -> Option<&MorphLeftOut> {
        let mut entries = self.of_mesh.iter().filter(|(key, _)| key.mesh == mesh);
        entries.find_map(|(_, entry)| entry.left_out.as_ref())
    }

    /// The trees that are ready, in no particular order. A mesh may have several: with different options, with and without
    /// joints.
    pub fn iter(&self) -> impl Iterator<Item = (AssetId<Mesh>, &Arc<MorphBvh>)> {
        let own = self.of_mesh.iter().filter(|(_, entry)| !entry.is_lent);
        own.filter_map(|(key, entry)| Some((key.mesh, entry.tree.as_ref()?)))
    }

    /// The number of trees in progress: their meshes are being copied, or they are being built in the background.
    #[must_use]
    pub fn building(&self) -> usize {
        self.of_mesh.values().filter(|entry| entry.is_coming()).count()
    }

    /// Whether a tree is being built or rebuilt.
    pub(crate) fn is_coming(&self, key: TreeKey) -> bool {
        self.of_mesh.get(&key).is_some_and(MeshTree::is_coming)
    }

    /// The vertices of a triangle, as numbered in the mesh, if the tree is the mesh's current one. Constant time.
    pub(crate) fn corners(&self, key: TreeKey, tree: &Arc<MorphBvh>, triangle: u32) -> Option<[u32; 3]> {
        let entry = self.of_mesh.get(&key)?;
        let is_present = entry.tree.as_ref().is_some_and(|present| Arc::ptr_eq(present, tree));
        entry.corners.get(triangle as usize).copied().filter(|_| is_present)
    }

    /// A number that changes whenever a tree is added or removed.
    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    /// Calls `work` with every new tree, in the background and before anyone gets the tree.
    pub fn on_built(&mut self, work: impl Fn(&Arc<MorphBvh>) + Send + Sync + 'static) {
        self.background.on_built.push(Arc::new(work));
    }

    /// Requests a tree, which is built once its mesh is loaded.
    pub(crate) fn request(&mut self, key: TreeKey, asked_by: Entity) {
        if !self.is_known(key) {
            self.waiting.push((key, asked_by));
        }
    }

    /// Whether a tree was requested and exists, is being built, or waits for its mesh.
    pub(crate) fn is_known(&self, key: TreeKey) -> bool {
        self.of_mesh.contains_key(&key) || self.waiting.iter().any(|(waiting, _)| *waiting == key)
    }

    /// Says that colliders may show something different, so trees may be unused.
    pub(crate) fn uses_changed(&mut self) {
        self.uses_changed = true;
    }

    /// Whether the meshes of all colliders have to be checked again.
    pub(crate) fn is_stale(&self) -> bool {
        self.stale
    }

    /// Whether unused trees have to be looked for; `anything_removed` says that a collider or what it shows was. A tree can only be
    /// dropped if its mesh has another one.
    pub(crate) fn may_have_unused(&mut self, anything_removed: bool) -> bool {
        if !std::mem::take(&mut self.uses_changed) && !anything_removed {
            return false;
        }
        let mut meshes = HashSet::<AssetId<Mesh>>::default();
        self.of_mesh.keys().any(|key| !meshes.insert(key.mesh))
    }

    /// Drops unused trees of a mesh while another tree of that mesh is in use.
    pub(crate) fn drop_unused(&mut self, used: &HashSet<TreeKey>) {
        let is_known = |key: &&TreeKey| self.of_mesh.contains_key(*key);
        let has_user: HashSet<AssetId<Mesh>> = used.iter().filter(is_known).map(|key| key.mesh).collect();
        let before = self.of_mesh.len();
        self.of_mesh
            .retain(|key, _| used.contains(key) || !has_user.contains(&key.mesh));
        self.version += (before - self.of_mesh.len()) as u64;
    }

    /// The tree of the current mesh. `None` while a modified mesh is being built, or if it could not be.
    pub(crate) fn up_to_date(&self, key: TreeKey) -> Option<&Arc<MorphBvh>> {
        let entry = self.of_mesh.get(&key)?;
        entry.tree.as_ref().filter(|_| entry.is_up_to_date())
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

/// Rebuilds the trees of modified meshes, and drops those of removed ones.
pub(crate) fn apply_asset_events(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut trees: ResMut<MorphTrees>,
    meshes: Res<Assets<Mesh>>,
    settings: Option<Res<MorphCollisionSettings>>,
    time: Option<Res<Time<Real>>>,
    saved: SavedTrees,
    complaints: Complaints,
) {
    let settings = settings.map(|settings| *settings).unwrap_or_default();
    let skip_bad = settings.skip_bad_triangles;
    trees
        .bypass_change_detection()
        .background
        .set_options(settings.tree_options);
    if trees.background.skip_bad != skip_bad {
        trees.background.skip_bad = skip_bad;
        for (key, entry) in &mut trees.of_mesh {
            match (&entry.work, meshes.get(key.mesh)) {
                (Work::Building(_), _) => entry.outdated = true,
                (_, Some(mesh)) if entry.has_bad_triangles() => entry.start(key, mesh, &complaints),
                _ => {}
            }
        }
    }
    let last_frame = time.map_or(Duration::ZERO, |time| time.delta());
    let pace = trees.background.turns.begin_frame(last_frame);
    trees.bypass_change_detection().left = (COPIED_PER_FRAME as f64 * pace) as usize;
    for event in events.read() {
        let trees = &mut *trees;
        match *event {
            AssetEvent::Modified { id } => {
                saved.forget(id);
                let Some(mesh) = meshes.get(id) else { continue };
                let MorphTrees {
                    of_mesh,
                    left,
                    background,
                    ..
                } = trees;
                for (key, entry) in of_mesh.iter_mut().filter(|(key, _)| key.mesh == id) {
                    entry.saved = None;
                    // A mesh that is modified all the time still gets trees.
                    match entry.work {
                        Work::Building(_) => entry.outdated = true,
                        Work::Reading(_) => {
                            let mut all = usize::MAX;
                            entry.start(key, mesh, &complaints);
                            entry.read_on(key, mesh, &mut all, background, &complaints);
                        }
                        Work::None => {
                            entry.start(key, mesh, &complaints);
                            entry.read_on(key, mesh, left, background, &complaints);
                        }
                    }
                }
            }
            AssetEvent::Removed { id } | AssetEvent::Unused { id } => {
                let before = trees.of_mesh.len();
                trees.of_mesh.retain(|key, _| key.mesh != id);
                complaints.forget(id);
                saved.forget(id);
                trees.version += (before - trees.of_mesh.len()) as u64;
                trees.waiting.retain(|(key, _)| key.mesh != id);
                // Entities that still show it may get it back under the same name.
                trees.stale = true;
            }
            AssetEvent::Added { .. } => trees.stale = true,
            AssetEvent::LoadedWithDependencies { .. } => {}
        }
    }
}

/// Reads requested meshes as soon as they are loaded, and starts building their trees.
pub(crate) fn start_trees(
    mut trees: ResMut<MorphTrees>,
    meshes: Res<Assets<Mesh>>,
    saved: SavedTrees,
    complaints: Complaints,
) {
    let MorphTrees {
        of_mesh,
        waiting,
        version,
        stale,
        left,
        background,
        ..
    } = trees.bypass_change_detection();
    *stale = false;
    waiting.retain(|&(key, asked_by)| {
        let Some(mesh) = meshes.get(key.mesh) else { return true };
        let sibling = of_mesh.iter().find_map(|(of, entry)| {
            let is_same = of.mesh == key.mesh && of.joints == key.joints;
            let is_usable = is_same && entry.is_up_to_date();
            let tree = entry.tree.as_ref().filter(|_| is_usable)?;
            Some((tree, entry.read(tree)))
        });
        let mut entry = MeshTree::new(asked_by);
        if let Some((tree, imported)) = sibling {
            // Settings do not affect answers.
            (entry.tree, entry.is_lent) = (Some(tree.clone()), true);
            (entry.corners, entry.left_out) = (imported.corners.clone(), imported.left_out.clone());
            *version += 1;
            entry.build(&key, background, Source::Read(imported));
        } else {
            match saved.find(&key, asked_by, background.options_of(&key), &complaints.names) {
                Saved::Coming => return true,
                Saved::Tree(restoring) => entry.build(&key, background, Source::Saved(restoring)),
                Saved::Layouts(layouts) => {
                    entry.saved = Some(layouts);
                    entry.start(&key, mesh, &complaints);
                }
                Saved::Nothing => entry.start(&key, mesh, &complaints),
            }
        }
        of_mesh.insert(key, entry);
        false
    });
    for (key, entry) in of_mesh {
        entry.apply_options(key, background);
        if let Some(mesh) = meshes.get(key.mesh) {
            entry.read_on(key, mesh, left, background, &complaints);
        }
    }
}

/// Replaces old trees by finished ones.
pub(crate) fn finish_trees(
    mut trees: ResMut<MorphTrees>,
    meshes: Res<Assets<Mesh>>,
    saved: SavedTrees,
    complaints: Complaints,
) {
    saved.log();
    let MorphTrees {
        of_mesh,
        version,
        left,
        background,
        ..
    } = trees.bypass_change_detection();
    for (key, entry) in of_mesh {
        let Work::Building(task) = &mut entry.work else {
            continue;
        };
        let Some(result) = check_ready(task) else { continue };
        entry.work = Work::None;
        *version += 1;
        match result {
            Ok((tree, imported)) => {
                (entry.tree, entry.is_lent) = (Some(tree), false);
                (entry.corners, entry.left_out) = (imported.corners, imported.left_out);
                if entry.error.take().is_some() {
                    complaints.forget(key.mesh);
                }
                if let Some(left_out) = &entry.left_out {
                    complaints.left_out(key.mesh, entry.asked_by, left_out);
                }
                if key.joints.is_some() {
                    complaints.further_influences(key.mesh, entry.asked_by);
                }
                entry.is_news = true;
            }
            Err(error) => entry.fail(key.mesh, error, &complaints),
        }
        if std::mem::take(&mut entry.outdated)
            && let Some(mesh) = meshes.get(key.mesh)
        {
            entry.start(key, mesh, &complaints);
            entry.read_on(key, mesh, left, background, &complaints);
        }
    }
}
