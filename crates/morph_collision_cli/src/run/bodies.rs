//! From a scene file to bodies that can be posed: every file read once, every tree built once, every placement checked.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use morph_collision::{BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::scenes::{self, Scene};

use crate::error::{CliError, FrameError, MeshError};

/// The bodies of a scene and what each does in every frame.
pub(crate) struct Cast {
    /// Named in errors.
    pub(crate) scene: PathBuf,
    /// One pose per body; bodies of one mesh share its tree.
    pub(crate) poses: Vec<Pose>,
    /// One state per body in every frame.
    pub(crate) frames: Vec<Vec<BodyState>>,
}

/// What a body does in a frame.
pub(crate) struct BodyState {
    /// One weight per target.
    pub(crate) weights: Vec<f32>,
    pub(crate) world_from_model: WorldFromModel,
}

impl Cast {
    /// Reads the models of a scene, `scene`, that was read from `path`, and checks all weights and placements.
    pub(crate) fn load(path: &Path, scene: &Scene, options: &BuildOptions) -> Result<Self, CliError> {
        let mut library = Library {
            scene: path,
            options,
            files: HashMap::new(),
            trees: HashMap::new(),
        };
        let mut trees = Vec::with_capacity(scene.bodies.len());
        for (body, spec) in scene.bodies.iter().enumerate() {
            trees.push(library.tree(body, &spec.model_path(path), spec.mesh)?);
        }
        let poses = || trees.iter().map(|tree| Pose::new(Arc::clone(tree))).collect::<Vec<_>>();
        // Weights are tried on poses of their own, so that the replay starts with untouched ones.
        let mut trial = poses();
        let mut frames = Vec::with_capacity(scene.frames.len());
        for (frame, states) in scene.frames.iter().enumerate() {
            let mut checked = Vec::with_capacity(states.len());
            for (body, (state, pose)) in states.iter().zip(&mut trial).enumerate() {
                let state = BodyState::check(state, pose).map_err(|reason| CliError::Frame {
                    scene: path.into(),
                    frame,
                    body,
                    reason,
                })?;
                checked.push(state);
            }
            frames.push(checked);
        }
        Ok(Self {
            scene: path.into(),
            poses: poses(),
            frames,
        })
    }
}

impl BodyState {
    fn check(state: &scenes::BodyState, pose: &mut Pose) -> Result<Self, FrameError> {
        let world_from_model = WorldFromModel::new(state.world_from_model())?;
        let weights = if state.weights.is_empty() {
            vec![0.0; pose.weights().len()]
        } else {
            state.weights.clone()
        };
        pose.set_weights(&weights)?;
        Ok(Self {
            weights,
            world_from_model,
        })
    }
}

/// Files and trees loaded so far.
struct Library<'a> {
    scene: &'a Path,
    options: &'a BuildOptions,
    files: HashMap<PathBuf, Vec<MorphMesh>>,
    trees: HashMap<(PathBuf, usize), Arc<MorphBvh>>,
}

impl Library<'_> {
    /// The tree of a mesh of a model file; `body` is whom an error speaks of.
    fn tree(&mut self, body: usize, model: &Path, mesh: usize) -> Result<Arc<MorphBvh>, CliError> {
        let key = (model.to_path_buf(), mesh);
        if let Some(tree) = self.trees.get(&key) {
            return Ok(Arc::clone(tree));
        }
        let meshes = match self.files.entry(model.to_path_buf()) {
            Entry::Occupied(read) => read.into_mut(),
            Entry::Vacant(unread) => unread.insert(read_meshes(model)?),
        };
        let Some(source) = meshes.get(mesh) else {
            let (scene, model, count) = (self.scene.into(), model.into(), meshes.len());
            return Err(CliError::NoSuchMesh {
                scene,
                body,
                model,
                mesh,
                count,
            });
        };
        let tree = build(source, self.options).map_err(|reason| {
            let (file, name) = (model.into(), source.name.clone());
            CliError::Mesh {
                file,
                mesh,
                name,
                reason,
            }
        })?;
        self.trees.insert(key, Arc::clone(&tree));
        Ok(tree)
    }
}

fn build(mesh: &MorphMesh, options: &BuildOptions) -> Result<Arc<MorphBvh>, MeshError> {
    let model = Arc::new(mesh.to_model()?);
    Ok(Arc::new(MorphBvh::build(model, options)?))
}
