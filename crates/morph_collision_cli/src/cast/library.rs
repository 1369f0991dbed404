//! Files read and meshes used so far.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Affine3A;
use morph_collision::MorphModel;
use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::SceneBody;
use morph_collision_models::skeleton::Skeleton;

use super::SetUp;
use crate::error::CliError;
use crate::files::clip_files::ClipFiles;
use crate::files::clips::{BrokenClips, ClipChoice, NoClip, read_clips};
use crate::files::model::{FileArgs, count_memory, read_mesh};

/// A mesh as a node shows it: the file, the mesh's index and the node's.
type Origin = (PathBuf, usize, Option<usize>);

pub(super) struct Library<'a> {
    options: &'a FileArgs,
    /// Shared by all files.
    pub(super) budget: MemoryBudget,
    pub(super) clip_files: ClipFiles<'a>,
    /// Keyed by real path, so that a file with two names is read once.
    pub(super) files: HashMap<PathBuf, GltfFile>,
    pub(super) meshes: Vec<MorphMesh>,
    /// For each mesh, how the node moves that shows it, if one is named.
    pub(super) placements: Vec<Option<Skeleton>>,
    /// For each mesh, where the instances of that node are in its space; read when a body names one.
    instances: Vec<Option<Vec<Affine3A>>>,
    origins: Vec<Origin>,
    known: HashMap<Origin, usize>,
    /// For each mesh, the clips that cannot be played; `None` until its clips have been read.
    broken: Vec<Option<BrokenClips>>,
}

impl<'a> Library<'a> {
    pub(super) fn new(options: &'a FileArgs, budget: &MemoryBudget, scene: &Path) -> Self {
        Self {
            options,
            clip_files: ClipFiles::new(options, budget, scene.parent().unwrap_or(Path::new(""))),
            budget: budget.clone(),
            files: HashMap::new(),
            meshes: Vec::new(),
            placements: Vec::new(),
            instances: Vec::new(),
            origins: Vec::new(),
            known: HashMap::new(),
            broken: Vec::new(),
        }
    }

    /// The index of a body's mesh. Errors name `scene` and `body`.
    pub(super) fn mesh(&mut self, scene: &Path, body: usize, spec: &SceneBody) -> Result<usize, CliError> {
        let model = spec.model_path(scene);
        // A path that cannot be resolved cannot be opened either, and opening it says why.
        let real = model.canonicalize().unwrap_or_else(|_| model.clone());
        let origin = (real.clone(), spec.mesh, spec.node);
        if let Some(&known) = self.known.get(&origin) {
            return Ok(known);
        }
        let file = match self.files.entry(real) {
            Entry::Occupied(open) => open.into_mut(),
            Entry::Vacant(unopened) => unopened.insert(self.options.open_within(&model, &self.budget)?),
        };
        let wrong = |reason: String| CliError::SceneBody {
            scene: scene.into(),
            body,
            reason,
        };
        let (index, count) = (spec.mesh, file.mesh_count());
        if index >= count {
            return Err(wrong(format!("{} has no mesh {index}, only {count}", model.display())));
        }
        if let Some(node) = spec.node
            && !file.nodes_of(index).any(|shows| shows == node)
        {
            let nodes: Vec<String> = file.nodes_of(index).map(|node| node.to_string()).collect();
            let nodes = if nodes.is_empty() {
                "none".to_owned()
            } else {
                nodes.join(", ")
            };
            let model = model.display();
            return Err(wrong(format!(
                "node {node} of {model} does not show mesh {index}; these nodes do: {nodes}"
            )));
        }
        let mesh = read_mesh(file, index, spec.node)?;
        let placing = spec.node.filter(|_| mesh.skin.is_none());
        let placement = placing.map(|node| file.placement(index, node)).transpose()?;
        self.meshes.push(mesh);
        self.placements.push(placement);
        self.instances.push(None);
        self.known.insert(origin.clone(), self.origins.len());
        self.origins.push(origin);
        self.broken.push(None);
        Ok(self.meshes.len() - 1)
    }

    /// Where a body is in the space of the node that shows its mesh. Errors name `scene` and `body`.
    pub(super) fn instance(
        &mut self,
        scene: &Path,
        body: usize,
        mesh: usize,
        spec: &SceneBody,
    ) -> Result<Affine3A, CliError> {
        let Some(instance) = spec.instance else {
            return Ok(Affine3A::IDENTITY);
        };
        let wrong = |reason: String| CliError::SceneBody {
            scene: scene.into(),
            body,
            reason,
        };
        let Some(node) = spec.node else {
            return Err(wrong(
                "\"instance\" has no effect without \"node\"; add a node, or remove it".to_owned(),
            ));
        };
        let (path, slot) = (&self.origins[mesh].0, &mut self.instances[mesh]);
        if let (None, Some(file)) = (&slot, self.files.get(path)) {
            *slot = file.instances(node)?;
        }
        let instances = slot.as_deref().unwrap_or_default();
        instances.get(instance).copied().ok_or_else(|| {
            let count = instances.len();
            let model = spec.model.display();
            wrong(format!(
                "node {node} of {model} has no instance {instance}; it has {count}"
            ))
        })
    }

    /// Reads the clips of a mesh's weights, unless that was done before.
    pub(super) fn read_clips(&mut self, mesh: usize) {
        let (path, index, node) = &self.origins[mesh];
        if let (None, Some(file)) = (&self.broken[mesh], self.files.get(path)) {
            let (placement, mesh_data) = (self.placements[mesh].as_ref(), &mut self.meshes[mesh]);
            let broken = read_clips(self.options, file, *index, *node, mesh_data, placement);
            self.broken[mesh] = Some(broken);
        }
    }

    /// Adds a clip of another file to a mesh; nothing if `name` names no file.
    pub(super) fn lend(&mut self, mesh: usize, name: &str) -> Result<(), String> {
        let (path, index, node) = &self.origins[mesh];
        let file = self.files.get(path).ok_or("its file was not read")?;
        let placement = self.placements[mesh].as_mut();
        self.clip_files
            .lend(name, file, (*index, *node), &mut self.meshes[mesh], placement)
    }

    /// The clips of a mesh with this name; its clips have been read.
    pub(super) fn clip(&self, mesh: usize, name: &str) -> Result<ClipChoice, String> {
        let file = self.files.get(&self.origins[mesh].0);
        let file = file.ok_or("its file was not read")?;
        let broken = self.broken[mesh].as_ref().ok_or("its clips were not read")?;
        let placement = self.placements[mesh].as_ref();
        let found = self.clip_files.find(name, file, &self.meshes[mesh], placement, broken);
        found.map_err(NoClip::reason)
    }

    /// Counts the memory of the trees of all meshes and of each body's own data.
    pub(super) fn count_memory(&self, of_bodies: &[usize], options: &impl SetUp) -> Result<(), CliError> {
        for (mesh, (path, index, _)) in self.origins.iter().enumerate() {
            let Some(file) = self.files.get(path) else { continue };
            let bodies = of_bodies.iter().filter(|&&of_body| of_body == mesh).count() as u64;
            let what = || format!("its trees for {bodies} bodies");
            let mesh = &self.meshes[mesh];
            let (tree, body) = options.bytes(mesh);
            let bytes = tree.saturating_add(bodies.saturating_mul(body));
            count_memory(file, *index, bytes, what)?;
        }
        Ok(())
    }

    /// What it holds, in words.
    pub(super) fn contents(&self) -> String {
        let triangles: usize = self.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        format!("{} meshes with {triangles} triangles", self.meshes.len())
    }

    /// The model of each mesh.
    ///
    /// # Errors
    /// A mesh is bad.
    pub(super) fn models(&self) -> Result<Vec<Arc<MorphModel>>, CliError> {
        let model = |(mesh, (real, index, _)): (&MorphMesh, &Origin)| {
            mesh.to_model().map(Arc::new).map_err(|reason| CliError::Mesh {
                file: self.files.get(real).map_or(real.as_path(), GltfFile::path).to_owned(),
                mesh: *index,
                name: mesh.name.clone(),
                reason: reason.into(),
            })
        };
        self.meshes.iter().zip(&self.origins).map(model).collect()
    }
}
