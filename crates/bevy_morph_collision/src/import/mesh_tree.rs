//! One mesh's tree, and the work that leads to it: the mesh is copied in parts, then the tree is built in the background.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task};
use morph_collision::{BuildOptions, MorphBvh};

use super::complaints::Complaints;
use super::mesh_data::{Built, ImportError, MeshData};
use super::tree_key::TreeKey;

/// Called in the background with each new tree, before it is handed out.
pub(super) type OnBuilt = Arc<dyn Fn(&Arc<MorphBvh>) + Send + Sync>;

/// The tree of one mesh, and its state.
pub(super) struct MeshTree {
    pub(super) tree: Option<Arc<MorphBvh>>,
    /// The vertices of the tree's triangles, as the mesh numbers them.
    pub(super) corners: Arc<[[u32; 3]]>,
    pub(super) work: Work,
    /// Whether the mesh was modified after what is being built was read.
    pub(super) outdated: bool,
    pub(super) error: Option<ImportError>,
    /// The collider that asked first, for messages.
    pub(super) asked_by: Entity,
}

/// The work in progress on a new tree.
pub(super) enum Work {
    None,
    Reading(MeshData),
    Building(Task<Result<Finished, ImportError>>),
}

/// A new tree, and the corners of its triangles.
pub(super) type Finished = (Arc<MorphBvh>, Arc<[[u32; 3]]>);

impl MeshTree {
    /// Whether a new tree is on its way.
    pub(super) fn is_coming(&self) -> bool {
        !matches!(self.work, Work::None)
    }

    /// Begins to read the mesh, from its first vertex.
    pub(super) fn start(&mut self, key: &TreeKey, mesh: &Mesh, complaints: &Complaints) {
        self.work = Work::None;
        match MeshData::of(mesh, key.joints) {
            Ok(data) => self.work = Work::Reading(data),
            Err(error) => self.fail(key.mesh, error, complaints),
        }
    }

    /// Reads on in a mesh that is being read, and begins a tree once all of it is there.
    pub(super) fn read_on(
        &mut self,
        key: &TreeKey,
        mesh: &Mesh,
        left: &mut usize,
        options: &BuildOptions,
        on_built: &[OnBuilt],
        complaints: &Complaints,
    ) {
        let Work::Reading(data) = &mut self.work else { return };
        match data.copy(mesh, left) {
            Ok(false) => {}
            Ok(true) => {
                if let Work::Reading(data) = std::mem::replace(&mut self.work, Work::None) {
                    self.build(key, options, on_built, move |options| {
                        let Built { tree, corners } = data.build(options)?;
                        Ok((tree.into(), corners.into()))
                    });
                }
            }
            Err(error) => {
                self.work = Work::None;
                self.fail(key.mesh, error, complaints);
            }
        }
    }

    /// Builds a tree in the background.
    pub(super) fn build(
        &mut self,
        key: &TreeKey,
        options: &BuildOptions,
        on_built: &[OnBuilt],
        build: impl FnOnce(&BuildOptions) -> Result<Finished, ImportError> + Send + 'static,
    ) {
        let options = key.settings.map_or(Ok(*options), |settings| settings.over(*options));
        let on_built = on_built.to_vec();
        let pool = AsyncComputeTaskPool::get_or_init(Default::default);
        self.work = Work::Building(pool.spawn(async move {
            let finished = build(&options?)?;
            on_built.iter().for_each(|work| work(&finished.0));
            Ok(finished)
        }));
    }

    pub(super) fn fail(&mut self, id: AssetId<Mesh>, error: ImportError, complaints: &Complaints) {
        complaints.unusable_mesh(id, self.asked_by, self.tree.is_some(), &error);
        self.error = Some(error);
    }
}
