//! Everything that can go wrong, worded for the person who typed the command.

use std::io;
use std::path::PathBuf;

use morph_collision::{InputError, WeightsError};
use morph_collision_models::gltf::read::{ReadError, Remedy};
use morph_collision_models::gltf::write::WriteError;
use morph_collision_models::inspect::MeshError;
use morph_collision_models::mesh::TogetherError;
use morph_collision_models::scenes::SceneError;
use morph_collision_models::text::Printable;
use thiserror::Error;

/// An error of any kind.
pub type AnyError = Box<dyn std::error::Error + Send + Sync>;

/// Why a body refuses a shape.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PoseError {
    /// The weights.
    #[error(transparent)]
    Weights(#[from] WeightsError),
    /// The joints or the placement.
    #[error(transparent)]
    Transform(#[from] InputError),
}

/// Why a command failed. Names the file and, if there is one, the mesh, frame, body and index.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum CliError {
    /// Boxed because it is by far the largest.
    #[error("{}{}", .0, Remedy::hint(.0.remedy()))]
    Read(Box<ReadError>),
    #[error("{}{}", .0, Remedy::hint(.0.remedy()))]
    Scene(#[from] SceneError),
    /// A model where a scene is expected.
    #[error(
        "{}: this is a model, not a scene file; `morph-collide scene {} OTHER.glb > scene.json` makes a scene of models, and `morph-collide sweep` tells where a model touches itself",
        file.display(),
        file.display()
    )]
    NotAScene { file: PathBuf },
    /// A scene where a model is expected.
    #[error(
        "{}: this is a scene file, not a model; `morph-collide run` replays scenes, and motion, sweep and export read them, too",
        file.display()
    )]
    NotAModel { file: PathBuf },
    #[error("{}: no usable mesh: {reason}", file.display())]
    NoUsableMesh { file: PathBuf, reason: String },
    /// `lint` has nothing to try.
    #[error(
        "{}: nothing was tried: no target and no animation moves any of its meshes; `morph-collide query --self` tells where a mesh touches itself at rest",
        file.display()
    )]
    NothingTried { file: PathBuf },
    /// A body of a scene cannot be read.
    #[error("{}: body {body}: {reason}", scene.display())]
    SceneBody {
        scene: PathBuf,
        body: usize,
        reason: String,
    },
    #[error("{}: mesh {mesh} \"{name}\": {reason}{}", file.display(), Remedy::hint(reason.remedy()))]
    Mesh {
        file: PathBuf,
        mesh: usize,
        name: String,
        reason: MeshError,
    },
    /// The meshes of a character cannot be searched as one.
    #[error(
        "{}: mesh {mesh} \"{}\" and the other meshes of its skeleton or node tree: {reason}; --mesh takes one mesh{}",
        file.display(), Printable(name), Remedy::hint(over_limit(matches!(reason, TogetherError::OverBudget(_))))
    )]
    Together {
        file: PathBuf,
        mesh: usize,
        name: String,
        reason: TogetherError,
    },
    /// Bodies cannot be made from the meshes of a scene.
    #[error(transparent)]
    SetUp(AnyError),
    #[error("{}: frame {frame}, body {body}: {reason}", scene.display())]
    Frame {
        scene: PathBuf,
        frame: usize,
        body: usize,
        reason: AnyError,
    },
    #[error(
        "{}: frame {frame}, bodies {body_a} and {body_b}: more than {most} pairs of triangles, for which the memory limit has no room; raise --memory-limit or use --mode first",
        scene.display()
    )]
    TooManyPairs {
        scene: PathBuf,
        frame: usize,
        body_a: u32,
        body_b: u32,
        most: usize,
    },
    #[error(
        "{}: frame {frame}: more than {most} pairs of triangles touch, for which the memory limit has no room; raise --memory-limit",
        input.display()
    )]
    TooManyTouches { input: PathBuf, frame: usize, most: usize },
    #[error(
        "{}: mesh {mesh} intersects itself in more than {most} pairs of triangles, for which the memory limit has no room; raise --memory-limit",
        file.display()
    )]
    TooManySelfPairs { file: PathBuf, mesh: usize, most: usize },
    /// The joints of a mesh cannot be used.
    #[error("{}: mesh {mesh} \"{}\": {reason}", file.display(), Printable(name))]
    Pose {
        file: PathBuf,
        mesh: usize,
        name: String,
        reason: InputError,
    },
    /// A state of a scene does not fit its body.
    #[error("{}: frame {frame}, body {body}: {reason}", scene.display())]
    State {
        scene: PathBuf,
        frame: usize,
        body: usize,
        reason: String,
    },
    /// A shape that `lint` tries and the mesh does not allow.
    #[error("{}: mesh {mesh} \"{}\": {}: {reason}", file.display(), Printable(name), Printable(shape))]
    Shape {
        file: PathBuf,
        mesh: usize,
        name: String,
        shape: String,
        /// Boxed because the variant would be the largest.
        reason: Box<PoseError>,
    },
    #[error("{flag}: {reason}")]
    Flag { flag: &'static str, reason: String },
    /// A mesh could not be exported.
    #[error(transparent)]
    Export(#[from] WriteError),
    /// Some of the files of a batch failed; each was reported.
    #[error("{failed} of {all} files failed")]
    Batch { failed: usize, all: usize },
    #[error("{}: cannot write: {reason}", file.display())]
    Write { file: PathBuf, reason: io::Error },
    #[error("cannot write to stdout: {0}")]
    Stdout(io::Error),
}

fn over_limit(is: bool) -> Option<Remedy> {
    is.then_some(Remedy::MoreMemory)
}

impl From<ReadError> for CliError {
    fn from(error: ReadError) -> Self {
        Self::Read(Box::new(error))
    }
}
