//! Turns a scene into bodies that can be posed. Reads every file once, sets up every mesh once and checks every placement.

mod library;
pub(crate) mod posed;
mod state;

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Affine3A;
use morph_collision::MorphModel;
use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::{Scene, SceneBody, SceneError};
use morph_collision_models::skeleton::Skeleton;
use morph_collision_models::weight_list::TargetNames;

use crate::error::{AnyError, CliError};
use crate::files::model::FileArgs;
use crate::messages::progress;

use library::Library;
use posed::placed;
pub(crate) use state::BodyState;

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
    /// The name of each body, or else that of its mesh.
    pub(crate) names: Vec<String>,
    /// How many pairs of triangles the memory limit has room for beside all that was read.
    pub(crate) most_pairs: usize,
    /// The distinct meshes of the bodies.
    pub(crate) meshes: Vec<MorphMesh>,
    /// For each mesh, how the node moves that shows it, if the scene names one.
    placements: Vec<Option<Skeleton>>,
    /// Where each body is in the space of the node that shows its mesh.
    instances: Vec<Affine3A>,
    /// The index of each body's mesh.
    pub(crate) mesh_of_body: Vec<usize>,
    /// One state per body in every frame.
    pub(crate) frames: Vec<Vec<BodyState>>,
}

/// A body's weights, joints and placement in a frame.
#[derive(Clone, Debug)]
pub struct Shape {
    /// One weight per target.
    pub weights: Arc<[f32]>,
    /// The matrices of the joints of a skinned mesh in world space.
    pub joints: Option<Vec<Affine3A>>,
    /// Where a mesh without joints is.
    pub world_from_model: Affine3A,
}

/// What bodies are made from.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The distinct meshes of the bodies.
    pub meshes: &'a [MorphMesh],
    /// The model of each mesh.
    pub models: &'a [Arc<MorphModel>],
    /// The index of each body's mesh.
    pub mesh_of_body: &'a [usize],
}

/// How a command turns meshes into bodies.
pub trait SetUp {
    /// The bodies of a scene.
    type Bodies;

    /// The bytes that a mesh's tree takes, and that each of its bodies takes.
    fn bytes(&self, mesh: &MorphMesh) -> (u64, u64);

    /// Creates the bodies.
    ///
    /// # Errors
    /// A mesh is not supported.
    fn set_up(&self, source: &Source<'_>) -> Result<Self::Bodies, AnyError>;
}

impl<B> Cast<B> {
    /// Reads the models of `scene`, which was read from `path`, and checks all weights and placements. `budget` lacks what the scene takes.
    pub(crate) fn load(
        path: &Path,
        scene: &Scene,
        options: &impl SetUp<Bodies = B>,
        files: &FileArgs,
        budget: &MemoryBudget,
    ) -> Result<Self, CliError> {
        let mut library = Library::new(files, budget, path);
        let mut of_bodies = Vec::with_capacity(scene.bodies.len());
        let mut instances = Vec::with_capacity(scene.bodies.len());
        for (body, spec) in scene.bodies.iter().enumerate() {
            let mesh = library.mesh(path, body, spec)?;
            instances.push(library.instance(path, body, mesh, spec)?);
            of_bodies.push(mesh);
        }
        library.count_memory(&of_bodies, options)?;
        progress::doing(format!("building the trees of {}", library.contents()));
        let models = library.models()?;
        let source = Source {
            meshes: &library.meshes,
            models: &models,
            mesh_of_body: &of_bodies,
        };
        let method = options.set_up(&source).map_err(CliError::SetUp)?;

        progress::doing("checking the scene's frames");
        let frames = frames(path, scene, &mut library, &models, &of_bodies)?;
        let name = |(body, spec): (usize, &SceneBody)| {
            let name = spec.name.clone();
            name.unwrap_or_else(|| library.meshes[of_bodies[body]].name.clone())
        };
        let names = scene.bodies.iter().enumerate().map(name).collect();
        let mut inputs = vec![path.to_owned()];
        inputs.extend(library.files.values().flat_map(GltfFile::files));
        inputs.extend(library.clip_files.inputs());
        Ok(Self {
            most_pairs: usize::try_from(budget.left() / BYTES_PER_PAIR).unwrap_or(usize::MAX),
            scene: path.into(),
            inputs,
            method,
            bodies: of_bodies.len(),
            names,
            meshes: library.meshes,
            placements: library.placements,
            instances,
            mesh_of_body: of_bodies,
            frames,
        })
    }

    /// The error for a shape that a body refuses.
    pub(crate) fn refused(&self, frame: usize, body: usize, reason: impl Into<AnyError>) -> CliError {
        CliError::Frame {
            scene: self.scene.clone(),
            frame,
            body,
            reason: reason.into(),
        }
    }

    /// The mesh of a body.
    pub(crate) fn mesh(&self, body: usize) -> &MorphMesh {
        &self.meshes[self.mesh_of_body[body]]
    }

    /// The shape of a body in a frame. Values from clips are computed here because storing them would take far more memory than a
    /// scene's file.
    pub(crate) fn shape(&self, frame: usize, body: usize) -> Shape {
        self.shape_of(&self.frames[frame][body], body)
    }

    /// The shape of a body while nothing moves it, where it stands in a frame.
    pub(crate) fn at_rest(&self, frame: usize, body: usize) -> Shape {
        let state = BodyState::at_rest(self.frames[frame][body].world_from_model);
        self.shape_of(&state, body)
    }

    fn shape_of(&self, state: &BodyState, body: usize) -> Shape {
        let mesh = self.mesh(body);
        let placement = self.placements[self.mesh_of_body[body]].as_ref();
        let joints = mesh.skin.as_ref().map(|skin| {
            let clip = state.clips.joints.map(|clip| &skin.skeleton.clips[clip]);
            placed(
                state.world_from_model,
                skin.skeleton.world_from_mesh(clip, state.seconds),
            )
        });
        let node = placement.and_then(|placement| {
            let clip = state.clips.node.map(|clip| &placement.clips[clip]);
            placement.world_from_mesh(clip, state.seconds).first().copied()
        });
        Shape {
            weights: state.weights(mesh),
            joints,
            world_from_model: state.world_from_model * node.unwrap_or(Affine3A::IDENTITY) * self.instances[body],
        }
    }
}

/// Checks all states of a scene.
fn frames(
    path: &Path,
    scene: &Scene,
    library: &mut Library<'_>,
    models: &[Arc<MorphModel>],
    of_bodies: &[usize],
) -> Result<Vec<Vec<BodyState>>, CliError> {
    let mut lent = HashSet::new();
    for (frame, states) in scene.frames.iter().enumerate() {
        for (body, (state, &mesh)) in states.iter().zip(of_bodies).enumerate() {
            let Some(name) = &state.clip else { continue };
            library.read_clips(mesh);
            if lent.insert((mesh, name)) {
                library.lend(mesh, name).map_err(|reason| CliError::State {
                    scene: path.into(),
                    frame,
                    body,
                    reason,
                })?;
            }
        }
    }
    library.clip_files.warn();
    let names: Vec<TargetNames<'_>> = library
        .meshes
        .iter()
        .map(|mesh| TargetNames::new(&mesh.target_names))
        .collect();
    let bytes = scene.frames.iter().flatten().map(BodyState::bytes).sum();
    let taken = library.budget.take(bytes, 1, || "the scene's frames".to_owned());
    taken.map_err(|over| SceneError::OverBudget {
        path: path.to_owned(),
        over,
    })?;
    let mut frames = Vec::with_capacity(scene.frames.len());
    for (frame, states) in scene.frames.iter().enumerate() {
        let mut checked = Vec::with_capacity(states.len());
        for (body, (state, &mesh)) in states.iter().zip(of_bodies).enumerate() {
            let wrong = |reason: String| CliError::State {
                scene: path.into(),
                frame,
                body,
                reason,
            };
            if state.time.is_some() && state.clip.is_none() {
                return Err(wrong(
                    "\"time\" has no effect without \"clip\"; add a clip, or remove it".to_owned(),
                ));
            }
            let clips = state.clip.as_ref().map(|name| library.clip(mesh, name));
            let clips = clips.transpose().map_err(wrong)?;
            let state = BodyState::check(
                state,
                clips.unwrap_or_default(),
                &library.meshes[mesh],
                &names[mesh],
                &models[mesh],
            );
            checked.push(state.map_err(wrong)?);
        }
        frames.push(checked);
    }
    Ok(frames)
}
