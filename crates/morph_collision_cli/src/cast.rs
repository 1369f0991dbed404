//! Turns a scene file into bodies that can be posed. Reads every file once, sets up every mesh once and checks every placement.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Affine3A;
use morph_collision::WorldFromModel;
use morph_collision_testkit::gltf_read::GltfFile;
use morph_collision_testkit::memory::MemoryBudget;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::rivals::{PoseError, SetUpError, WeightLimits};
use morph_collision_testkit::scenes::{self, Scene};

use crate::error::CliError;
use crate::model_file::{FileArgs, count_memory, find_clip, read_clips, read_mesh};

/// Upper bound on the bytes that a pair of triangles takes while a replay lists it: twice as a hit and once as a pair, in lists
/// that grow.
const BYTES_PER_PAIR: u64 = 128;

/// The bodies of a scene and what each does in every frame. `B` holds the bodies in the form that a command needs.
pub(crate) struct Cast<B> {
    /// For error messages.
    pub(crate) scene: PathBuf,
    /// Every file that was read; outputs must not replace any of them.
    pub(crate) inputs: Vec<PathBuf>,
    /// Bodies of the same mesh share its data.
    pub(crate) method: B,
    pub(crate) bodies: usize,
    /// How many pairs of triangles the memory limit has room for.
    pub(crate) most_pairs: usize,
    /// The distinct meshes of the bodies.
    pub(crate) meshes: Vec<MorphMesh>,
    /// The index of each body's mesh.
    pub(crate) mesh_of_body: Vec<usize>,
    /// One state per body in every frame.
    pub(crate) frames: Vec<Vec<BodyState>>,
}

/// What a body does in a frame.
pub(crate) struct BodyState {
    /// One weight per target, or `None` if a clip gives them. Bodies of a mesh that are at rest share one list.
    weights: Option<Arc<[f32]>>,
    pub(crate) world_from_model: Affine3A,
    /// The clips of weights and of joints, if the state names a clip that has them.
    clips: [Option<usize>; 2],
    /// The time in the clips.
    seconds: f32,
}

/// A body's weights and joints in a frame.
pub(crate) struct Shape {
    pub(crate) weights: Arc<[f32]>,
    /// The matrices of the joints of a skinned mesh in world space.
    pub(crate) joints: Option<Vec<Affine3A>>,
}

/// How a command turns meshes into bodies.
pub(crate) trait SetUp {
    type Bodies;

    /// The bytes that a mesh's tree takes, and that each of its bodies takes.
    fn bytes(&self, mesh: &MorphMesh) -> (u64, u64);

    /// Creates bodies of the given meshes.
    fn set_up(&self, meshes: &[MorphMesh], mesh_of_body: &[usize]) -> Result<Self::Bodies, SetUpError>;
}

impl<B> Cast<B> {
    /// Reads the models of `scene`, which was read from `path`, and checks all weights and placements.
    pub(crate) fn load(
        path: &Path,
        scene: &Scene,
        options: &impl SetUp<Bodies = B>,
        files: &FileArgs,
    ) -> Result<Self, CliError> {
        let mut library = Library {
            budget: MemoryBudget::new(files.memory_limit()),
            files: HashMap::new(),
            meshes: Vec::new(),
            origins: Vec::new(),
            has_clips: Vec::new(),
        };
        let mut of_bodies = Vec::with_capacity(scene.bodies.len());
        for (body, spec) in scene.bodies.iter().enumerate() {
            of_bodies.push(library.mesh(path, body, &spec.model_path(path), spec.mesh, files)?);
        }
        library.count_memory(&of_bodies, options)?;
        let method = options
            .set_up(&library.meshes, &of_bodies)
            .map_err(|error| library.blame(error))?;

        let limits: Vec<WeightLimits> = library.meshes.iter().map(WeightLimits::of).collect();
        let at_rest = |mesh: &MorphMesh| Arc::from(vec![0.0; mesh.targets.len()]);
        let at_rest: Vec<Arc<[f32]>> = library.meshes.iter().map(at_rest).collect();
        let mut frames = Vec::with_capacity(scene.frames.len());
        for (frame, states) in scene.frames.iter().enumerate() {
            let mut checked = Vec::with_capacity(states.len());
            for (body, (state, &mesh)) in states.iter().zip(&of_bodies).enumerate() {
                let clips = state.clip.as_ref().map(|name| library.clip(mesh, name)).transpose()?;
                let clips = clips.transpose().map_err(|reason| CliError::NoSuchClip {
                    scene: path.into(),
                    frame,
                    body,
                    reason,
                })?;
                let state = BodyState::check(state, clips.unwrap_or_default(), &at_rest[mesh], &limits[mesh]);
                checked.push(state.map_err(|reason| CliError::Frame {
                    scene: path.into(),
                    frame,
                    body,
                    reason,
                })?);
            }
            frames.push(checked);
        }
        let mut inputs = vec![path.to_owned()];
        inputs.extend(library.files.values().flat_map(GltfFile::files));
        Ok(Self {
            most_pairs: usize::try_from(files.memory_limit() / BYTES_PER_PAIR).unwrap_or(usize::MAX),
            scene: path.into(),
            inputs,
            method,
            bodies: of_bodies.len(),
            meshes: library.meshes,
            mesh_of_body: of_bodies,
            frames,
        })
    }

    /// The weights and joints of a body in a frame. Values from clips are computed here because storing them would take far more
    /// memory than a scene's file.
    pub(crate) fn shape(&self, frame: usize, body: usize) -> Shape {
        let (state, mesh) = (&self.frames[frame][body], &self.meshes[self.mesh_of_body[body]]);
        let [of_weights, of_joints] = state.clips;
        let weights = match (&state.weights, of_weights) {
            (Some(weights), _) => Arc::clone(weights),
            (None, Some(clip)) => mesh.animations[clip].sample(state.seconds).into(),
            (None, None) => Arc::from(Vec::new()),
        };
        let joints = mesh.skin.as_ref().map(|skin| {
            let clip = of_joints.map(|clip| &skin.skeleton.clips[clip]);
            let joints = skin.skeleton.world_from_mesh(clip, state.seconds);
            joints.into_iter().map(|joint| state.world_from_model * joint).collect()
        });
        Shape { weights, joints }
    }
}

impl BodyState {
    fn check(
        state: &scenes::BodyState,
        clips: [Option<usize>; 2],
        at_rest: &Arc<[f32]>,
        limits: &WeightLimits,
    ) -> Result<Self, PoseError> {
        let world_from_model = state.world_from_model();
        WorldFromModel::new(world_from_model)?;
        let weights = match (state.weights.is_empty(), clips[0]) {
            (true, Some(_)) => None,
            (true, None) => Some(Arc::clone(at_rest)),
            (false, _) => Some(state.weights.as_slice().into()),
        };
        weights.as_ref().map_or(Ok(()), |weights| limits.check(weights))?;
        Ok(Self {
            weights,
            world_from_model,
            clips,
            seconds: state.time.unwrap_or(0.0),
        })
    }
}

/// Files read and meshes used so far.
struct Library {
    /// Shared by all files.
    budget: MemoryBudget,
    /// Keyed by real path, so that a file with two names is read once.
    files: HashMap<PathBuf, GltfFile>,
    meshes: Vec<MorphMesh>,
    /// File and index of each mesh.
    origins: Vec<(PathBuf, usize)>,
    /// For each mesh, whether its weight clips have been read.
    has_clips: Vec<bool>,
}

impl Library {
    /// The index of a mesh of a model file. Errors name `scene` and `body`.
    fn mesh(
        &mut self,
        scene: &Path,
        body: usize,
        model: &Path,
        mesh: usize,
        files: &FileArgs,
    ) -> Result<usize, CliError> {
        // A path that cannot be resolved cannot be opened either, and opening it says why.
        let real = model.canonicalize().unwrap_or_else(|_| model.to_owned());
        let known = self
            .origins
            .iter()
            .position(|(file, index)| *file == real && *index == mesh);
        if let Some(known) = known {
            return Ok(known);
        }
        let file = match self.files.entry(real.clone()) {
            Entry::Occupied(open) => open.into_mut(),
            Entry::Vacant(unopened) => unopened.insert(files.open_within(model, &self.budget)?),
        };
        let count = file.mesh_count();
        if mesh >= count {
            let (scene, model) = (scene.into(), model.into());
            return Err(CliError::NoSuchMesh {
                scene,
                body,
                model,
                mesh,
                count,
            });
        }
        let source = read_mesh(file, mesh)?;
        self.meshes.push(source);
        self.origins.push((real, mesh));
        self.has_clips.push(false);
        Ok(self.meshes.len() - 1)
    }

    /// The clips of weights and of joints with this name. Clips are read when the first one is named. The inner error says that
    /// there is no such clip.
    fn clip(&mut self, mesh: usize, name: &str) -> Result<Result<[Option<usize>; 2], String>, CliError> {
        let (path, index) = &self.origins[mesh];
        if let (false, Some(file)) = (self.has_clips[mesh], self.files.get(path)) {
            read_clips(file, *index, &mut self.meshes[mesh])?;
            self.has_clips[mesh] = true;
        }
        Ok(find_clip(&self.meshes[mesh], name))
    }

    /// Counts the memory of the trees of all meshes and of each body's own data.
    fn count_memory(&self, of_bodies: &[usize], options: &impl SetUp) -> Result<(), CliError> {
        for (mesh, (path, index)) in self.origins.iter().enumerate() {
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

    /// Adds the file and index of the mesh to a method's error.
    fn blame(&self, error: SetUpError) -> CliError {
        match error {
            SetUpError::Model { mesh, reason } => {
                let (real, index) = self.origins[mesh].clone();
                CliError::Mesh {
                    file: self.files.get(&real).map_or(real, |file| file.path().to_owned()),
                    mesh: index,
                    name: self.meshes[mesh].name.clone(),
                    reason: reason.into(),
                }
            }
            other => CliError::SetUp(other),
        }
    }
}
