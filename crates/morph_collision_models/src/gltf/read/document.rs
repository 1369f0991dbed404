//! The parts of a file's JSON that meshes and their clips need.
//!
//! Elements of the top-level lists are parsed on first use, so broken elements matter only if they are used.

use serde::Deserialize;
use serde_json::value::RawValue;

use super::attributes::Attributes;
use super::expressions::Extensions;
use super::list::{AgainError, Element, bytes_of, or_default, parse_again};
use crate::memory::{MemoryBudget, OverBudget};
use crate::text::Printable;

pub use super::list::ElementError;
pub(super) use super::list::{List, abridged};

/// The top level.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Root {
    /// Required, so that arbitrary JSON is not mistaken for glTF.
    pub(super) asset: Asset,
    #[serde(default)]
    pub(super) extensions_required: Vec<String>,
    // Only messages need it.
    #[serde(default, deserialize_with = "or_default")]
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions: Option<Element<Extensions>>,
    #[serde(default)]
    pub(super) buffers: List<Buffer>,
    #[serde(default)]
    pub(super) buffer_views: List<View>,
    #[serde(default)]
    pub(super) accessors: List<Accessor>,
    #[serde(default)]
    pub(super) meshes: List<Mesh>,
    /// The scene to draw, if it is not the first.
    #[serde(default, deserialize_with = "or_default")]
    pub(super) scene: Option<usize>,
    #[serde(default)]
    pub(super) scenes: List<Scene>,
    #[serde(default)]
    pub(super) nodes: List<Node>,
    #[serde(default)]
    pub(super) skins: List<Skin>,
    #[serde(default)]
    pub(super) animations: List<Animation>,
    // Only their names are used.
    #[serde(default, deserialize_with = "or_default")]
    pub(super) materials: List<Material>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Material {
    pub(super) name: Option<String>,
}

/// Which version of glTF a file is written in, and which one a reader must know.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Asset {
    version: Option<String>,
    min_version: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) byte_length: u64,
    pub(super) uri: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<usize>,
    #[serde(default)]
    pub(super) extensions: ViewExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub(super) ext_meshopt: Option<Element<MeshoptView>>,
    #[serde(rename = "KHR_meshopt_compression")]
    pub(super) khr_meshopt: Option<Element<MeshoptView>>,
}

/// Where the compressed data of a view is, and what it decodes to.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct MeshoptView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: usize,
    pub(super) count: u64,
    pub(super) mode: String,
    pub(super) filter: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) name: Option<String>,
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    /// The component type of sparse indices.
    #[serde(default)]
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) primitives: Vec<Primitive>,
    /// Default weights.
    pub(super) weights: Option<Vec<f32>>,
    pub(super) extras: Option<Box<RawValue>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    #[serde(default)]
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    /// Triangles by default.
    #[serde(default = "triangles")]
    pub(super) mode: u32,
    #[serde(default, deserialize_with = "or_default")]
    pub(super) material: Option<usize>,
    #[serde(default)]
    pub(super) targets: Vec<Target>,
    pub(super) extras: Option<Box<RawValue>>,
    #[serde(default)]
    pub(super) extensions: PrimitiveExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<Element<DracoStream>>,
}

/// A view that holds a compressed primitive, and the numbers of its attributes in there.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct DracoStream {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) attributes: Attributes,
}

const fn triangles() -> u32 {
    gltf::json::mesh::TRIANGLES
}

#[derive(Debug, Deserialize)]
pub(super) struct Target {
    #[serde(rename = "POSITION")]
    pub(super) positions: Option<usize>,
}

/// The nodes that are drawn together, with everything below them.
#[derive(Debug, Deserialize)]
pub(super) struct Scene {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    /// Default weights of its mesh, instead of the mesh's own.
    pub(super) weights: Option<Vec<f32>>,
    #[serde(default)]
    pub(super) children: Vec<usize>,
    pub(super) matrix: Option<[f32; 16]>,
    pub(super) translation: Option<[f32; 3]>,
    pub(super) rotation: Option<[f32; 4]>,
    pub(super) scale: Option<[f32; 3]>,
    #[serde(default)]
    pub(super) extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Element<Instancing>>,
    #[serde(rename = "KHR_node_visibility")]
    visibility: Option<Element<Visibility>>,
}

/// A node that shows its mesh several times.
#[derive(Debug, Deserialize)]
pub(super) struct Instancing {
    #[serde(default)]
    pub(super) attributes: InstanceAttributes,
}

/// One element of each for every instance.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) struct InstanceAttributes {
    pub(super) translation: Option<usize>,
    pub(super) rotation: Option<usize>,
    pub(super) scale: Option<usize>,
}

/// A node that may be hidden with everything below it.
#[derive(Debug, Deserialize)]
struct Visibility {
    visible: Option<bool>,
}

impl Node {
    /// Whether the node hides itself and everything below it at rest.
    pub(super) fn is_hidden(&self, budget: &MemoryBudget) -> Result<bool, ElementError> {
        let visibility = self.extensions.visibility.as_ref();
        let visibility = visibility.map(|visibility| visibility.get(budget)).transpose()?;
        Ok(visibility.is_some_and(|visibility| visibility.visible == Some(false)))
    }
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub(super) inverse_bind_matrices: Option<usize>,
    #[serde(default)]
    pub(super) joints: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Animation {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) channels: List<Channel>,
    #[serde(default)]
    pub(super) samplers: List<Sampler>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Channel {
    pub(super) sampler: usize,
    pub(super) target: ChannelTarget,
}

#[derive(Debug, Deserialize)]
pub(super) struct ChannelTarget {
    /// Absent if an extension says what is animated.
    pub(super) node: Option<usize>,
    pub(super) path: String,
    #[serde(default)]
    pub(super) extensions: ChannelTargetExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct ChannelTargetExtensions {
    #[serde(rename = "KHR_animation_pointer")]
    pub(super) pointer: Option<AnimationPointer>,
}

/// What is animated, as a JSON pointer into the file.
#[derive(Debug, Deserialize)]
pub(super) struct AnimationPointer {
    pub(super) pointer: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sampler {
    pub(super) input: usize,
    pub(super) output: usize,
    pub(super) interpolation: Option<String>,
}

impl Root {
    /// Parses the top level. A byte-order mark before it is skipped.
    pub(super) fn parse(json: &[u8], budget: &MemoryBudget) -> Result<Self, RootError> {
        /// Of other versions, only this part can be relied on.
        #[derive(Deserialize)]
        struct AnyVersion {
            #[serde(default)]
            asset: Asset,
        }
        budget.take(bytes_of(json), 1, || "the JSON".into())?;
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let root = serde_json::from_slice::<Self>(json).or_else(|error| {
            let text = std::str::from_utf8(json).map_err(|_| RootError::Json(error.to_string()))?;
            parse_again(text, budget).map_err(|again| match again {
                AgainError::Json(message) => RootError::Json(message),
                AgainError::OverBudget(_) => RootError::Json(error.to_string()),
            })
        });
        let asset = match &root {
            Ok(root) => &root.asset,
            Err(_) => &serde_json::from_slice::<AnyVersion>(json).map_or_else(|_| Asset::default(), |any| any.asset),
        };
        asset.check().map_err(RootError::Version)?;
        root
    }
}

impl Asset {
    /// Whether this reader knows the file's version: any 2.x, or the smallest version that a reader must know if the file says so.
    /// The error is the version that is needed.
    fn check(&self) -> Result<(), String> {
        let number = |version: &str| {
            let (major, minor) = version.split_once('.')?;
            Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
        };
        let (needed, known) = match (&self.min_version, &self.version) {
            (Some(least), _) => (least, number(least) == Some((2, 0))),
            (None, Some(version)) => (version, number(version).is_some_and(|(major, _)| major == 2)),
            (None, None) => return Ok(()),
        };
        if known { Ok(()) } else { Err(abridged(needed)) }
    }
}

/// Why the top level cannot be parsed.
#[derive(Debug, thiserror::Error)]
pub(super) enum RootError {
    #[error("{0}")]
    Json(String),
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The file needs another version of glTF.
    #[error("it needs glTF {}, and only 2.0 is read; convert it to glTF 2.0", Printable(.0))]
    Version(String),
}
