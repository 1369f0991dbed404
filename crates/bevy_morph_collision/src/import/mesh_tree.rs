//! The tree of one mesh, and the work to build it: the mesh is copied in parts, then the tree is built in the background.

use std::sync::Arc;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task};
use morph_collision::{BuildOptions, MorphBvh, MorphBvhBuilder};
use tracing::error;

use super::complaints::Complaints;
use super::error::ImportError;
use super::left_out::MorphLeftOut;
use super::mesh_data::{Finished, Imported, MeshData};
use super::saved::{Layouts, Restoring};
use super::tree_key::TreeKey;
use super::turns::Turns;
use crate::components::MorphTreeOptions;

/// Called in the background with each new tree, before it is handed out.
pub(super) type OnBuilt = Arc<dyn Fn(&Arc<MorphBvh>) + Send + Sync>;

/// What background tasks need.
#[derive(Clone, Default)]
pub(super) struct Background {
    pub(super) turns: Turns,
    pub(super) on_built: Vec<OnBuilt>,
    /// Whether meshes are read without their bad triangles.
    pub(super) skip_bad: bool,
    /// How trees are built for colliders without options of their own: the last valid ones of the app.
    pub(super) options: BuildOptions,
    /// What the app's settings say, valid or not.
    pub(super) wanted: MorphTreeOptions,
}

/// The tree of one mesh, and its state.
pub(super) struct MeshTree {
    pub(super) tree: Option<Arc<MorphBvh>>,
    /// Whether the tree is one of the same mesh with other settings, in use until its own first tree is built.
    pub(super) is_lent: bool,
    /// Whether colliders have not seen the latest tree or error yet.
    pub(super) is_news: bool,
    /// The vertices of the tree's triangles, as numbered in the mesh.
    pub(super) corners: Arc<[[u32; 3]]>,
    /// What the tree lacks because it is bad.
    pub(super) left_out: Option<MorphLeftOut>,
    pub(super) work: Work,
    /// Saved trees, one of which may fit the mesh. Taken once it is read.
    pub(super) saved: Option<Layouts>,
    /// Whether the tree in progress is of the same mesh as the current one, but with other settings.
    is_same_mesh: bool,
    /// Whether the mesh was modified after the data in progress was read.
    pub(super) outdated: bool,
    pub(super) error: Option<ImportError>,
    /// The collider that first requested it, for messages.
    pub(super) asked_by: Entity,
}

/// The work in progress on a new tree.
pub(super) enum Work {
    None,
    Reading(MeshData),
    Building(Task<Result<Finished, ImportError>>),
}

/// The source of a tree.
pub(super) enum Source {
    Copy(MeshData),
    /// The mesh has already been read for another tree.
    Read(Imported),
    /// It was saved.
    Saved(Restoring),
}

impl Background {
    /// Takes over the app's options. Invalid ones are logged once, and the last valid ones stay in use.
    pub(super) fn set_options(&mut self, wanted: MorphTreeOptions) {
        if std::mem::replace(&mut self.wanted, wanted) != wanted {
            match wanted.build_options() {
                Ok(options) => self.options = options,
                Err(error) => {
                    error!("`MorphCollisionSettings::tree_options`: {error}; the last good ones stay in force");
                }
            }
        }
    }

    /// How the tree with a key is built.
    pub(super) fn options_of(&self, key: &TreeKey) -> Option<BuildOptions> {
        key.options.map_or(Some(self.options), |own| own.build_options().ok())
    }
}

impl MeshTree {
    /// Whether a new tree is in progress.
    pub(super) fn is_coming(&self) -> bool {
        !matches!(self.work, Work::None)
    }

    /// An entry without a tree.
    pub(super) fn new(asked_by: Entity) -> Self {
        Self {
            tree: None,
            is_lent: false,
            is_news: false,
            corners: Arc::default(),
            left_out: None,
            work: Work::None,
            saved: None,
            is_same_mesh: false,
            outdated: false,
            error: None,
            asked_by,
        }
    }

    /// Whether the tree, if there is one, belongs to the current state of the mesh.
    pub(super) fn is_up_to_date(&self) -> bool {
        let is_same = match self.work {
            Work::None => true,
            Work::Reading(_) => false,
            Work::Building(_) => self.is_same_mesh,
        };
        is_same && !self.outdated && self.error.is_none()
    }

    /// Starts to read the mesh, from its first vertex.
    pub(super) fn start(&mut self, key: &TreeKey, mesh: &Mesh, complaints: &Complaints) {
        self.work = Work::None;
        match MeshData::of(mesh, key.joints) {
            Ok(data) => self.work = Work::Reading(data),
            Err(error) => self.fail(key.mesh, error, complaints),
        }
    }

    /// Continues to read a mesh, and starts building the tree once reading is complete.
    pub(super) fn read_on(
        &mut self,
        key: &TreeKey,
        mesh: &Mesh,
        left: &mut usize,
        background: &Background,
        complaints: &Complaints,
    ) {
        let Work::Reading(data) = &mut self.work else { return };
        let start = Instant::now();
        let copied = data.copy(mesh, left);
        background.turns.spend(start.elapsed());
        match copied {
            Ok(false) => {}
            Ok(true) => {
                if let Work::Reading(data) = std::mem::replace(&mut self.work, Work::None) {
                    self.build(key, background, Source::Copy(data));
                }
            }
            Err(error) => {
                self.work = Work::None;
                self.fail(key.mesh, error, complaints);
            }
        }
    }

    /// Builds a tree in the background.
    pub(super) fn build(&mut self, key: &TreeKey, background: &Background, source: Source) {
        self.is_same_mesh = matches!(source, Source::Read(_));
        let Background {
            turns,
            on_built,
            skip_bad,
            options,
            ..
        } = background.clone();
        let options = key.options.map_or(Ok(options), |own| own.build_options());
        let saved = self.saved.take();
        let pool = AsyncComputeTaskPool::get_or_init(Default::default);
        self.work = Work::Building(pool.spawn(async move {
            let options = options?;
            let (tree, imported) = match source {
                Source::Saved(restoring) => restoring.await,
                Source::Read(imported) => build(&turns, imported, &options, None).await,
                Source::Copy(data) => {
                    let start = Instant::now();
                    let imported = data.into_model(skip_bad)?;
                    turns.after_step(start.elapsed()).await;
                    build(&turns, imported, &options, saved).await
                }
            };
            for work in on_built {
                let start = Instant::now();
                work(&tree);
                turns.after_step(start.elapsed()).await;
            }
            Ok((tree, imported))
        }));
    }

    /// Rebuilds the tree if the app's options have changed since. If the mesh is invalid now, its last valid tree stays as it
    /// is.
    pub(super) fn apply_options(&mut self, key: &TreeKey, background: &Background) {
        if key.options.is_none()
            && !self.is_coming()
            && self.error.is_none()
            && let Some(tree) = self.tree.as_ref().filter(|tree| *tree.options() != background.options)
        {
            let source = Source::Read(self.read(tree));
            self.build(key, background, source);
        }
    }

    /// The mesh that was read for one of its trees.
    pub(super) fn read(&self, tree: &MorphBvh) -> Imported {
        Imported {
            model: tree.model().clone(),
            corners: self.corners.clone(),
            left_out: self.left_out.clone(),
        }
    }

    /// Whether the mesh is refused because of bad triangles, or used without them.
    pub(super) fn has_bad_triangles(&self) -> bool {
        self.left_out.is_some() || self.error.as_ref().is_some_and(ImportError::is_about_a_triangle)
    }

    pub(super) fn fail(&mut self, id: AssetId<Mesh>, error: ImportError, complaints: &Complaints) {
        if std::mem::take(&mut self.is_lent) {
            self.tree = None;
        }
        complaints.unusable_mesh(id, self.asked_by, self.tree.is_some(), &error);
        self.error = Some(error);
        self.is_news = true;
    }
}

/// Builds the tree of a mesh, or restores it if it was saved.
async fn build(turns: &Turns, imported: Imported, options: &BuildOptions, saved: Option<Layouts>) -> Finished {
    let model = &imported.model;
    let restored = saved.and_then(|saved| saved.restore(model, options));
    let builder = restored.unwrap_or_else(|| MorphBvhBuilder::new(model.clone(), options));
    (Arc::new(turns.finish(builder).await), imported)
}
