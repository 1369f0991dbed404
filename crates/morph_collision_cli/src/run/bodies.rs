//! From a scene file to bodies that can be posed: every file read once, every mesh set up once, every placement checked.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use glam::Affine3A;
use morph_collision::WorldFromModel;
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::rivals::{Method, PoseError, SetUpError, WeightLimits};
use morph_collision_testkit::scenes::{self, Scene};

use super::options::MethodArgs;
use crate::error::CliError;

/// The bodies of a scene and what each does in every frame.
pub(crate) struct Cast {
    /// Named in errors.
    pub(crate) scene: PathBuf,
    /// Holds the bodies; those of one mesh share what is made of it.
    pub(crate) method: Box<dyn Method>,
    pub(crate) bodies: usize,
    /// One state per body in every frame.
    pub(crate) frames: Vec<Vec<BodyState>>,
}

/// What a body does in a frame.
pub(crate) struct BodyState {
    /// One weight per target.
    pub(crate) weights: Vec<f32>,
    pub(crate) world_from_model: Affine3A,
}

impl Cast {
    /// Reads the models of a scene, `scene`, that was read from `path`, and checks all weights and placements.
    pub(crate) fn load(path: &Path, scene: &Scene, options: &MethodArgs) -> Result<Self, CliError> {
        let mut library = Library::default();
        let mut of_bodies = Vec::with_capacity(scene.bodies.len());
        for (body, spec) in scene.bodies.iter().enumerate() {
            of_bodies.push(library.mesh(path, body, &spec.model_path(path), spec.mesh)?);
        }
        let method = options
            .method()
            .set_up_tuned(&library.meshes, &of_bodies, &options.build(), options.tuning())
            .map_err(|error| library.blame(error))?;

        let limits: Vec<WeightLimits> = library.meshes.iter().map(WeightLimits::of).collect();
        let mut frames = Vec::with_capacity(scene.frames.len());
        for (frame, states) in scene.frames.iter().enumerate() {
            let mut checked = Vec::with_capacity(states.len());
            for (body, (state, &mesh)) in states.iter().zip(&of_bodies).enumerate() {
                let targets = library.meshes[mesh].targets.len();
                let state = BodyState::check(state, targets, &limits[mesh]).map_err(|reason| CliError::Frame {
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
            method,
            bodies: of_bodies.len(),
            frames,
        })
    }
}

impl BodyState {
    fn check(state: &scenes::BodyState, targets: usize, limits: &WeightLimits) -> Result<Self, PoseError> {
        let world_from_model = state.world_from_model();
        WorldFromModel::new(world_from_model)?;
        let weights = if state.weights.is_empty() {
            vec![0.0; targets]
        } else {
            state.weights.clone()
        };
        limits.check(&weights)?;
        Ok(Self {
            weights,
            world_from_model,
        })
    }
}

/// Files read and meshes used so far.
#[derive(Default)]
struct Library {
    files: HashMap<PathBuf, Vec<MorphMesh>>,
    meshes: Vec<MorphMesh>,
    /// Where each of the meshes is from: file and index.
    origins: Vec<(PathBuf, usize)>,
}

impl Library {
    /// The index of a mesh of a model file; `scene` and `body` are whom an error speaks of.
    fn mesh(&mut self, scene: &Path, body: usize, model: &Path, mesh: usize) -> Result<usize, CliError> {
        let known = self
            .origins
            .iter()
            .position(|(file, index)| file == model && *index == mesh);
        if let Some(known) = known {
            return Ok(known);
        }
        let meshes = match self.files.entry(model.to_path_buf()) {
            Entry::Occupied(read) => read.into_mut(),
            Entry::Vacant(unread) => unread.insert(read_meshes(model)?),
        };
        let count = meshes.len();
        let Some(source) = meshes.get_mut(mesh) else {
            let (scene, model) = (scene.into(), model.into());
            return Err(CliError::NoSuchMesh {
                scene,
                body,
                model,
                mesh,
                count,
            });
        };
        self.meshes.push(std::mem::take(source));
        self.origins.push((model.to_path_buf(), mesh));
        Ok(self.meshes.len() - 1)
    }

    /// Says which file's mesh a method refuses.
    fn blame(&self, error: SetUpError) -> CliError {
        match error {
            SetUpError::Model { mesh, reason } => {
                let (file, index) = self.origins[mesh].clone();
                CliError::Mesh {
                    file,
                    mesh: index,
                    name: self.meshes[mesh].name.clone(),
                    reason: reason.into(),
                }
            }
            other => CliError::SetUp(other),
        }
    }
}
