//! Restores the trees of a glTF file's meshes from the file beside it, while Bevy loads it.
//!
//! A loader has all the time it needs: nothing waits for it. So nothing is left to do for the trees when the meshes appear.

use std::future::ready;
use std::sync::Arc;
use std::thread;

use bevy::asset::io::AssetReaderError;
use bevy::asset::{AssetPath, LoadContext, ReadAssetBytesError};
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler, GltfExtensionHandlers};
use bevy::gltf::gltf::{Gltf, Mesh as GltfFileMesh, Primitive};
use bevy::gltf::{GltfAssetLabel, GltfMesh};
use bevy::mesh::{Indices, MeshVertexAttribute};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, block_on};
use morph_collision::{SavedTree, TreeFile};
use tracing::debug;

use super::super::gltf::repair_split_meshes;
use super::super::mesh_data::{Finished, MeshData};
use super::super::trees::MorphTrees;
use super::super::turns::Turns;
use super::file::{EXTENSION, MorphTreeFileError, decoded};
use super::fit::{OTHER_MESH, fitting};
use super::store::{Restored, Restoring, Store};

/// From now on, looks for a file beside every glTF file. Does nothing without `GltfPlugin`.
pub(super) fn look_beside_models(app: &mut App) {
    // First, whatever the order of the plugins.
    repair_split_meshes(app);
    let world = app.world_mut();
    let (Some(handlers), Some(trees), Some(store)) = (
        world.get_resource::<GltfExtensionHandlers>(),
        world.get_resource::<MorphTrees>(),
        world.get_resource::<Store>(),
    ) else {
        return;
    };
    let handler = Beside {
        store: store.clone(),
        turns: trees.turns(),
        read: false,
        file: None,
    };
    block_on(async { handlers.0.write().await.push(Box::new(handler)) });
}

/// The file beside the model that is being loaded. For every model, the loader starts with a clone of the registered handler, which has read
/// nothing.
#[derive(Clone)]
struct Beside {
    store: Store,
    turns: Turns,
    /// Whether the file was looked for.
    read: bool,
    file: Option<(String, Arc<TreeFile>)>,
}

impl GltfExtensionHandler for Beside {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    /// The only one that can wait.
    async fn on_gltf_primitive(
        &mut self,
        context: &mut LoadContext<'_>,
        gltf: &Gltf,
        _: &GltfFileMesh<'_>,
        _: &Primitive<'_>,
        _: &[Vec<u8>],
        _: &HashMap<Box<str>, MeshVertexAttribute>,
        _: bool,
        _: bool,
        _: &mut Option<Mesh>,
    ) {
        if !std::mem::replace(&mut self.read, true) {
            self.file = read(context, gltf, &self.store).await;
        }
    }

    fn on_gltf_mesh(&mut self, context: &mut LoadContext<'_>, mesh: &GltfFileMesh, _: Handle<GltfMesh>) {
        let Some((path, file)) = self.file.clone() else { return };
        for primitive in mesh.primitives() {
            let label = label(mesh, &primitive);
            for saved in file.trees.iter().filter(|saved| saved.label == label) {
                let asset = context.get_labeled(&label).and_then(|asset| asset.get::<Mesh>());
                let Some(mesh) = asset else { continue };
                let name = format!("{}#{label}", context.path());
                let Some(tree) = self.restore(mesh, saved, &path, &name) else {
                    continue;
                };
                let id = context.get_label_handle::<Mesh>(label.clone()).id();
                let restored = Restored {
                    joints: saved.joints.map(|joints| joints as usize),
                    options: *saved.layout.options(),
                    file: path.clone(),
                    tree,
                };
                self.store.lock().restored.entry(id).or_default().push(restored);
            }
        }
    }
}

impl Beside {
    /// Restores a tree, at once or, on the thread that draws, in steps. `None` if that is impossible, which is logged unless the mesh is bad:
    /// that is logged once it collides.
    fn restore(&self, mesh: &Mesh, saved: &SavedTree, file: &str, name: &str) -> Option<Restoring> {
        // Reading the mesh takes as long as it is large, and a file may have many trees of it. Each of them has to be as large.
        let corners = mesh
            .try_indices_option()
            .ok()?
            .map_or(mesh.count_vertices(), Indices::len);
        if saved.layout.triangle_count() != corners / 3 {
            self.store.refuse(file, name, OTHER_MESH);
            return None;
        }
        let mut data = MeshData::of(mesh, saved.joints.map(|joints| joints as usize)).ok()?;
        let mut all = usize::MAX;
        data.copy(mesh, &mut all).ok()?;
        let imported = data.into_model(false).ok()?;
        let builder = fitting(std::iter::once(saved), &imported.model, None);
        let builder = builder.map_err(|reason| self.store.refuse(file, name, &reason)).ok()?;
        debug!("the tree of {name} comes from {file}");
        let turns = self.turns.clone();
        let restore = async move { (Arc::new(turns.finish(builder).await), imported) };
        if self.turns.has_thread(thread::current().id()) {
            return Some(Box::pin(
                AsyncComputeTaskPool::get_or_init(Default::default).spawn(restore),
            ));
        }
        let finished: Finished = block_on(restore);
        Some(Box::pin(ready(finished)))
    }
}

fn label(mesh: &GltfFileMesh, primitive: &Primitive) -> String {
    let (mesh, primitive) = (mesh.index(), primitive.index());
    GltfAssetLabel::Primitive { mesh, primitive }.to_string()
}

/// Reads the file beside a model, if there is one. If it cannot be used, the log says why.
async fn read(context: &mut LoadContext<'_>, gltf: &Gltf, store: &Store) -> Option<(String, Arc<TreeFile>)> {
    let model = context.path().clone();
    let mut name = model.path().as_os_str().to_owned();
    name.push(".");
    name.push(EXTENSION);
    let path = AssetPath::from_path_buf(name.into()).with_source(model.source().clone_owned());
    let refuse = |reason: String| {
        store.warn(format!(
            "`{path}` is not used, and the trees of `{model}` are built instead: {reason}"
        ));
        None
    };
    let bytes = match context.read_asset_bytes(&path).await {
        Ok(bytes) => bytes,
        Err(ReadAssetBytesError::AssetReaderError(AssetReaderError::NotFound(_))) => return None,
        Err(error) => return refuse(error.to_string()),
    };
    let again = format!("`morph-collide bake {model}` writes it anew");
    let file = match decoded(&bytes) {
        Ok(file) => file,
        Err(MorphTreeFileError::Content(error)) => return refuse(format!("{error}. {again}")),
        Err(error) => return refuse(error.to_string()),
    };
    let labels: Vec<String> = gltf
        .meshes()
        .flat_map(|mesh| {
            mesh.primitives()
                .map(move |primitive| label(&mesh, &primitive))
                .collect::<Vec<_>>()
        })
        .collect();
    match file.trees.iter().find(|saved| !labels.contains(&saved.label)) {
        Some(saved) => refuse(format!(
            "it is of another model, with a mesh `{}`. {again}",
            saved.label
        )),
        None => Some((path.to_string(), Arc::new(file))),
    }
}
