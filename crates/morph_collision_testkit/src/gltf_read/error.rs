//! What can be wrong with a file, each with the place where it is wrong.

use std::path::PathBuf;

use super::document::ElementError;
use super::skin_error::SkinProblem;
use crate::memory::OverBudget;
use crate::printable::Printable;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file itself could not be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Neither a `.glb` container nor glTF JSON.
    #[error("{}: not a glTF 2.0 file: {reason}", path.display())]
    NotGltf {
        /// The file.
        path: PathBuf,
        /// What was found instead.
        reason: String,
    },
    /// The file needs an extension that changes how its geometry is stored.
    #[error("{}: needs the glTF extension {}, which this reader does not know{}", path.display(), Printable(extension), advice(extension))]
    Extension {
        /// The file.
        path: PathBuf,
        /// The extension's name.
        extension: String,
    },
    /// The file is no regular file.
    #[error("{}: not a regular file", path.display())]
    NotRegular {
        /// The file.
        path: PathBuf,
    },
    /// The file as a whole is too large.
    #[error("{}: {over}", path.display())]
    OverBudget {
        /// The file.
        path: PathBuf,
        /// The part that is too large.
        over: OverBudget,
    },
    /// A mesh is broken.
    #[error("{}: mesh {mesh} \"{}\": {problem}", path.display(), Printable(name))]
    Mesh {
        /// The file.
        path: PathBuf,
        /// The mesh's index in the file.
        mesh: usize,
        /// The mesh's name, or the one made up for it.
        name: String,
        /// The problem.
        problem: Box<MeshProblem>,
    },
    /// What moves a mesh is broken.
    #[error("{}: the skin of mesh {mesh} \"{}\": {problem}", path.display(), Printable(name))]
    Skin {
        /// The file.
        path: PathBuf,
        /// The mesh's index in the file.
        mesh: usize,
        /// The mesh's name, or the one made up for it.
        name: String,
        /// The problem.
        problem: Box<SkinProblem>,
    },
    /// An animation is broken.
    #[error("{}: animation {animation} \"{}\": {problem}", path.display(), Printable(name))]
    Animation {
        /// The file.
        path: PathBuf,
        /// The animation's index in the file.
        animation: usize,
        /// The animation's name, or the one made up for it.
        name: String,
        /// The problem.
        problem: Box<AnimationProblem>,
    },
}

/// How a caller may let a file through that was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// A larger [`ReadOptions::memory_limit`](super::ReadOptions).
    MoreMemory,
    /// [`ReadOptions::any_path`](super::ReadOptions).
    AnyPath,
}

impl Remedy {
    /// The end of a message: which option of `morph-collide` lets the file through.
    pub fn hint(remedy: Option<Self>) -> &'static str {
        match remedy {
            None => "",
            Some(Self::MoreMemory) => "; --memory-limit raises it",
            Some(Self::AnyPath) => "; pass --allow-any-path to read it",
        }
    }
}

impl ReadError {
    /// What would let the file through, where a limit or a rule of the reader keeps it out.
    pub fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget { .. } => Some(Remedy::MoreMemory),
            Self::NotRegular { .. } => Some(Remedy::AnyPath),
            Self::Mesh { problem, .. } => match &**problem {
                MeshProblem::OverBudget(_) | MeshProblem::Element(ElementError::OverBudget(_)) => {
                    Some(Remedy::MoreMemory)
                }
                MeshProblem::Accessor { problem, .. } => problem.remedy(),
                _ => None,
            },
            Self::Animation { problem, .. } => match &**problem {
                AnimationProblem::OverBudget { .. } | AnimationProblem::Element(ElementError::OverBudget(_)) => {
                    Some(Remedy::MoreMemory)
                }
                AnimationProblem::Accessor { problem, .. } => problem.remedy(),
                _ => None,
            },
            Self::Skin { problem, .. } => problem.remedy(),
            Self::Io { .. } | Self::NotGltf { .. } | Self::Extension { .. } => None,
        }
    }
}

/// What to do about compressed geometry.
fn advice(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" => {
            "; undo the compression, for example with `npx @gltf-transform/cli cp IN.glb OUT.glb`"
        }
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "; undo the compression, for example with `gltfpack -i IN.glb -o OUT.glb -noq -kn -ke` (version 0.21 or later)"
        }
        _ => "",
    }
}

/// What is wrong with a mesh.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum MeshProblem {
    /// The mesh's JSON is missing or malformed.
    #[error("it {0}")]
    Element(ElementError),
    /// It would take more memory than the file may.
    #[error(transparent)]
    OverBudget(OverBudget),
    /// A primitive has no positions.
    #[error("primitive {primitive} has no POSITION attribute")]
    MissingPositions {
        /// The primitive's index in the mesh.
        primitive: usize,
    },
    /// A primitive's mode is none that glTF defines.
    #[error("primitive {primitive} has an unknown mode")]
    UnknownMode {
        /// The primitive's index in the mesh.
        primitive: usize,
    },
    /// An accessor cannot be decoded.
    #[error("primitive {primitive}, {attribute}: {problem}")]
    Accessor {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// What the accessor holds.
        attribute: String,
        /// Why it cannot be decoded.
        problem: AccessorProblem,
    },
    /// Primitives of one mesh share their weights, so they must have equally many targets.
    #[error("primitive {primitive} has {found} morph targets, but primitive 0 has {expected}")]
    TargetCount {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// Its number of targets.
        found: usize,
        /// The number of targets of the first primitive.
        expected: usize,
    },
    /// A target has more or fewer displacements than there are vertices.
    #[error("primitive {primitive}, target {target} has {found} displacements for {expected} vertices")]
    TargetLength {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// The target's index.
        target: usize,
        /// Its number of displacements.
        found: usize,
        /// The number of vertices.
        expected: usize,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("primitive {primitive}, index {position} refers to vertex {vertex} of {vertices}")]
    VertexOutOfRange {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// The place in the primitive's list of indices.
        position: usize,
        /// The vertex named there.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A list of separate triangles ends in the middle of one.
    #[error("primitive {primitive} has {corners} triangle corners, which is no multiple of 3")]
    IncompleteTriangle {
        /// The primitive's index in the mesh.
        primitive: usize,
        /// The number of corners.
        corners: usize,
    },
    /// More vertices or triangles than 32 bits can number.
    #[error("primitive {primitive} takes the mesh beyond 2^32 vertices or triangles")]
    TooLarge {
        /// The primitive's index in the mesh.
        primitive: usize,
    },
}

/// What is wrong with an animation of weights or joints.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum AnimationProblem {
    /// The animation's JSON is malformed.
    #[error("it {0}")]
    Element(ElementError),
    /// A channel's JSON is malformed.
    #[error("channel {channel} {problem}")]
    Channel {
        /// The channel's index in the animation.
        channel: usize,
        /// The problem.
        problem: ElementError,
    },
    /// A channel would take more memory than the file may.
    #[error("channel {channel}: {over}")]
    OverBudget {
        /// The channel's index in the animation.
        channel: usize,
        /// The part that is too large.
        over: OverBudget,
    },
    /// A tangent of a cubic spline is not finite.
    #[error("channel {channel}, key {key}, target {target}: the tangent {tangent} is not finite")]
    Tangent {
        /// The channel's index in the animation.
        channel: usize,
        /// The key's index.
        key: usize,
        /// The target's index.
        target: usize,
        /// The tangent.
        tangent: f32,
    },
    /// A channel names a sampler, a node or a mesh that does not exist.
    #[error("channel {channel} refers to a {what} that does not exist")]
    Dangling {
        /// The channel's index in the animation.
        channel: usize,
        /// What is missing.
        what: &'static str,
    },
    /// A sampler's accessor cannot be decoded.
    #[error("channel {channel}, {what}: {problem}")]
    Accessor {
        /// The channel's index in the animation.
        channel: usize,
        /// Key times or weights.
        what: &'static str,
        /// Why it cannot be decoded.
        problem: AccessorProblem,
    },
    /// A sampler's interpolation is none that glTF defines.
    #[error("channel {channel} has an unknown interpolation")]
    UnknownInterpolation {
        /// The channel's index in the animation.
        channel: usize,
    },
    /// The keys do not go with the weights.
    #[error("channel {channel} has {found} weights, but {keys} keys of {targets} targets need {expected}")]
    WeightCount {
        /// The channel's index in the animation.
        channel: usize,
        /// The number of weights in the file.
        found: usize,
        /// The number of keys.
        keys: usize,
        /// The number of targets of the mesh.
        targets: usize,
        /// The number of weights there should be.
        expected: usize,
    },
    /// The keys do not go with what moves a node.
    #[error("channel {channel} has {found} {what}, but {keys} keys need {expected}")]
    ValueCount {
        /// The channel's index in the animation.
        channel: usize,
        /// Translations, rotations or scales.
        what: &'static str,
        /// The number in the file.
        found: usize,
        /// The number of keys.
        keys: usize,
        /// The number there should be.
        expected: usize,
    },
    /// What moves a node is not finite.
    #[error("channel {channel}, key {key}: the {what} are not finite")]
    NotFinite {
        /// The channel's index in the animation.
        channel: usize,
        /// The key's index.
        key: usize,
        /// Translations, rotations or scales.
        what: &'static str,
    },
    /// A key's time is not finite, or earlier than the key before it.
    #[error("channel {channel}, key {key} is at {time} s, which is not after the key before it")]
    KeyOrder {
        /// The channel's index in the animation.
        channel: usize,
        /// The key's index.
        key: usize,
        /// Its time.
        time: f32,
    },
    /// A weight is not finite.
    #[error("channel {channel}, key {key}, target {target}: the weight {weight} is not finite")]
    Weight {
        /// The channel's index in the animation.
        channel: usize,
        /// The key's index.
        key: usize,
        /// The target's index.
        target: usize,
        /// The weight.
        weight: f32,
    },
}

/// Why an accessor cannot be decoded.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum AccessorProblem {
    /// There is no such accessor, or it is malformed.
    #[error("accessor {accessor} {problem}")]
    Element {
        /// The accessor's index.
        accessor: usize,
        /// The problem.
        problem: ElementError,
    },
    /// It refers to a buffer view that does not exist or is malformed.
    #[error("accessor {accessor} refers to buffer view {view}, which {problem}")]
    View {
        /// The accessor's index.
        accessor: usize,
        /// The view's index.
        view: usize,
        /// The problem with the view.
        problem: ElementError,
    },
    /// Its buffer cannot be loaded.
    #[error("accessor {accessor}: {problem}")]
    Buffer {
        /// The accessor's index.
        accessor: usize,
        /// Which buffer, and why.
        problem: Box<BufferProblem>,
    },
    /// Its component type and shape are not what this place allows.
    #[error("accessor {accessor} holds {} where {expected} is needed", Printable(found))]
    Type {
        /// The accessor's index.
        accessor: usize,
        /// What it holds.
        found: String,
        /// What is needed.
        expected: &'static str,
    },
    /// Its elements reach beyond its buffer view, or the view beyond its buffer.
    #[error("accessor {accessor} reaches beyond its buffer")]
    OutOfBounds {
        /// The accessor's index.
        accessor: usize,
    },
    /// Its stride is smaller than one element.
    #[error("accessor {accessor} has elements of {size} bytes every {stride} bytes")]
    Stride {
        /// The accessor's index.
        accessor: usize,
        /// Bytes per element.
        size: usize,
        /// Bytes from one element to the next.
        stride: usize,
    },
    /// A sparse accessor replaces an element that does not exist.
    #[error("accessor {accessor} replaces element {element} of {count}")]
    SparseIndex {
        /// The accessor's index.
        accessor: usize,
        /// The element it replaces.
        element: usize,
        /// Its number of elements.
        count: usize,
    },
}

impl AccessorProblem {
    pub(super) fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::Element { problem, .. } | Self::View { problem, .. } => match problem {
                ElementError::OverBudget(_) => Some(Remedy::MoreMemory),
                ElementError::Missing | ElementError::Malformed(_) => None,
            },
            Self::Buffer { problem, .. } => match &problem.fault {
                BufferFault::OverBudget(_) | BufferFault::Element(ElementError::OverBudget(_)) => {
                    Some(Remedy::MoreMemory)
                }
                BufferFault::Outside(_) => Some(Remedy::AnyPath),
                _ => None,
            },
            Self::Type { .. } | Self::OutOfBounds { .. } | Self::Stride { .. } | Self::SparseIndex { .. } => None,
        }
    }
}

/// A buffer that cannot be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("buffer {buffer}{}: {fault}", uri.as_deref().map(|uri| format!(" \"{}\"", Printable(uri))).unwrap_or_default())]
pub struct BufferProblem {
    /// The buffer's index in the file.
    pub buffer: usize,
    /// Its URI, abridged, if it has one.
    pub uri: Option<String>,
    /// Why it cannot be loaded.
    pub fault: BufferFault,
}

/// Why a buffer cannot be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BufferFault {
    /// Its JSON is missing or malformed.
    #[error("it {0}")]
    Element(#[from] ElementError),
    /// It has no URI, and the file has no binary chunk for it.
    #[error("it has no URI, and the file holds no binary data for it")]
    NoChunk,
    /// Only the file's own bytes are at hand.
    #[error("it is in another file; here everything has to be in one file, as in a .glb")]
    NoDirectory,
    /// It leads where a file may not lead unless that is allowed.
    #[error("refused, because {0}")]
    Outside(&'static str),
    /// Its URI has a scheme that nothing is read from.
    #[error("nothing is read from URIs that begin with \"{}:\"; store the buffer beside the file", Printable(.0))]
    Scheme(String),
    /// Its URI is no path.
    #[error("the URI is not a path")]
    NoPath,
    /// Its URI is not UTF-8.
    #[error("the URI is not UTF-8 after percent-decoding")]
    NotUtf8,
    /// Its data URI is not in base64.
    #[error("the data URI is not in base64")]
    Encoding,
    /// Its data URI cannot be decoded.
    #[error("the data URI is not valid base64: {0}")]
    Base64(String),
    /// Its file cannot be read.
    #[error("{0}")]
    Io(String),
    /// It has fewer bytes than it promises.
    #[error("it has {found} bytes, but its byteLength is {promised}")]
    Short {
        /// How many it has.
        found: usize,
        /// How many it promises.
        promised: u64,
    },
    /// It would take more memory than the file may.
    #[error(transparent)]
    OverBudget(OverBudget),
}
