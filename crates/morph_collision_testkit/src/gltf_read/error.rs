//! What can be wrong with a file, each with the place where it is wrong.

use std::path::PathBuf;

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
    #[error("{}: needs the glTF extension {extension}, which this reader does not know", path.display())]
    Extension {
        /// The file.
        path: PathBuf,
        /// The extension's name.
        extension: String,
    },
    /// A buffer is missing, unreadable or too short.
    #[error("{}: cannot load the buffers: {reason}", path.display())]
    Buffer {
        /// The file.
        path: PathBuf,
        /// Which buffer, and why.
        reason: String,
    },
    /// A mesh is broken.
    #[error("{}: mesh {mesh} \"{name}\": {problem}", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// The mesh's index in the file.
        mesh: usize,
        /// The mesh's name, or the one made up for it.
        name: String,
        /// What is wrong with it.
        problem: Box<MeshProblem>,
    },
    /// A weight animation is broken.
    #[error("{}: animation {animation} \"{name}\": {problem}", path.display())]
    Animation {
        /// The file.
        path: PathBuf,
        /// The animation's index in the file.
        animation: usize,
        /// The animation's name, or the one made up for it.
        name: String,
        /// What is wrong with it.
        problem: Box<AnimationProblem>,
    },
}

/// What is wrong with a mesh.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum MeshProblem {
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

/// What is wrong with a weight animation.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum AnimationProblem {
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
    /// There is no such accessor.
    #[error("accessor {0} does not exist")]
    Missing(usize),
    /// It refers to a buffer view that does not exist.
    #[error("accessor {accessor} refers to buffer view {view}, which does not exist")]
    MissingView {
        /// The accessor's index.
        accessor: usize,
        /// The view's index.
        view: usize,
    },
    /// Its component type and shape are not what this place allows.
    #[error("accessor {accessor} holds {found} where {expected} is needed")]
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
    /// It stores nothing and claims to hold more zeros than any mesh needs.
    #[error("accessor {accessor} claims {count} elements without storing them")]
    Unstored {
        /// The accessor's index.
        accessor: usize,
        /// Its number of elements.
        count: u64,
    },
}
