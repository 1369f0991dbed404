//! Why a mesh cannot collide.

use bevy::mesh::{MeshAccessError, PrimitiveTopology};
use bevy::prelude::*;
use morph_collision::{HullError, InputError, ModelError};
use thiserror::Error;

/// Why a mesh cannot collide.
#[derive(Reflect, Clone, Debug, PartialEq, Error)]
#[reflect(opaque)]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ImportError {
    /// Bevy could not load it; the text is Bevy's reason. Only this error may also concern a scene.
    #[error("it could not be loaded: {0}")]
    NotLoaded(String),
    /// The mesh data is only for the renderer, which takes it away.
    #[error(
        "its data does not stay in main memory: give it `RenderAssetUsages::default()` instead of `RENDER_WORLD` (for glTF \
         files `GltfLoaderSettings::load_meshes`)"
    )]
    Extracted,
    /// The mesh is made of points or lines.
    #[error("its topology is {0:?}, only TriangleList and TriangleStrip have triangles")]
    Topology(PrimitiveTopology),
    /// There is no position attribute.
    #[error("it has no vertex positions")]
    NoPositions,
    /// Positions have an unsupported format.
    #[error("its positions are {0}, only Float32x3 and Snorm16x4 (see `Mesh::compress_positions`) can be read")]
    PositionFormat(&'static str),
    /// Positions are compressed, but the box to decode them is missing.
    #[error("its positions are compressed (Snorm16x4), but there is no `Mesh::final_aabb` to decode them with")]
    NoPositionBounds,
    /// Joint indices have an unsupported format.
    #[error("its joint indices are {0}, only Uint16x4 and Uint8x4 can be read")]
    JointFormat(&'static str),
    /// Joint weights have an unsupported format.
    #[error(
        "its joint weights are {0}, only Float32x4, Float16x4, Unorm16x4, Unorm8x4, Snorm16x4 and Snorm8x4 can be read"
    )]
    JointWeightFormat(&'static str),
    /// A triangle list ends in the middle of a triangle.
    #[error("it has {0} indices or unindexed vertices, not a multiple of 3")]
    IncompleteTriangle(usize),
    /// The morph displacements do not fit the vertices.
    #[error("it has {displacements} morph displacements, which is not {targets} for each of its {vertices} vertices")]
    TargetLength {
        /// The number of displacements of all targets together.
        displacements: usize,
        /// The number of vertices.
        vertices: usize,
        /// The number of targets, as text because it may be unknown.
        targets: String,
    },
    /// The vertices were split for flat shading, but the morph displacements were not.
    #[error(
        "it has {displacements} morph displacements for {vertices} vertices: it seems to have no normals, so that its vertices \
         were split for flat shading, but not its displacements. Export it with normals, or let `MorphCollisionPlugin` repair it \
         while Bevy loads it from glTF (feature `gltf`, on by default)"
    )]
    SplitVertices {
        /// The number of displacements of all targets together.
        displacements: usize,
        /// The number of vertices after the split.
        vertices: usize,
    },
    /// The model data is invalid.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Its vertices have no convex hull that can be used.
    #[error(transparent)]
    Hull(#[from] HullError),
    /// A setting of [`MorphTreeOptions`](crate::components::MorphTreeOptions) is out of range.
    #[error(transparent)]
    Settings(#[from] InputError),
}

impl ImportError {
    /// Whether the rest of the mesh could be used without the bad triangles.
    pub(super) fn is_about_a_triangle(&self) -> bool {
        use ModelError::{BadCoordinate, BadInfluence, IndexOutOfRange, JointOutOfRange, WeightsTooLarge};
        match self {
            Self::IncompleteTriangle(_) => true,
            Self::Model(error) => matches!(
                error,
                BadCoordinate { .. }
                    | BadInfluence { .. }
                    | IndexOutOfRange { .. }
                    | JointOutOfRange { .. }
                    | WeightsTooLarge { .. }
            ),
            _ => false,
        }
    }
}

impl From<MeshAccessError> for ImportError {
    fn from(error: MeshAccessError) -> Self {
        match error {
            MeshAccessError::ExtractedToRenderWorld => Self::Extracted,
            MeshAccessError::NotFound => Self::NoPositions,
        }
    }
}
