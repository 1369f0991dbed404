//! Reads the meshes of a glTF 2.0 file (`.gltf` or `.glb`) with their morph targets, skins and animations.
//!
//! The order of the work is the order of the files: take the JSON out of its container (`document`), fetch a buffer when it is first
//! used (`buffers`, `uri`), open and decode accessors (`accessor`), put primitives together (`primitive`, `triangles`), read what moves
//! them (`skin`, `influences`) and collect the clips (`animation`, `joint_animation`).
//!
//! Files come from anywhere. Every index is checked where it is used, and nothing is checked that is not used: a file with a broken
//! texture, a broken second mesh or a missing buffer that no mesh needs still has its first mesh. Whatever is allocated is counted
//! against the file's [`MemoryBudget`] first. Buffers in other files have to be regular files in the directory of the model or below
//! ([`ReadOptions::any_path`] lifts that). Images are never decoded. Transforms of nodes that show a mesh are not applied: a mesh is read in
//! its own space. Default weights are ignored.

mod accessor;
mod animation;
mod buffers;
mod document;
mod error;
mod influences;
mod joint_animation;
mod primitive;
mod skin;
mod skin_error;
mod triangles;
mod uri;

use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

pub use self::animation::Clips;
pub use self::document::ElementError;
pub use self::error::{AccessorProblem, AnimationProblem, BufferFault, BufferProblem, MeshProblem, ReadError, Remedy};
pub use self::joint_animation::JointClips;
pub use self::skin_error::SkinProblem;

use self::buffers::Buffers;
use self::document::{Mesh, Root, RootError};
use crate::memory::{self, MemoryBudget};
use crate::mesh::MorphMesh;

/// Size of the header of a `.glb` file in bytes.
const GLB_HEADER: usize = 12;

/// Required extensions that leave a mesh's geometry as it is, by the beginning of their names.
const HARMLESS: [&str; 26] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_animation_pointer",
    "KHR_mesh_quantization",
    "KHR_node_",
    "KHR_physics_",
    "KHR_audio_",
    "KHR_xmp",
    "EXT_texture_",
    "EXT_lights_",
    "EXT_materials_",
    "EXT_mesh_gpu_instancing",
    "EXT_mesh_features",
    "EXT_instance_features",
    "EXT_structural_metadata",
    "EXT_property_",
    "MSFT_texture_",
    "MSFT_packing_",
    "MSFT_lod",
    "ADOBE_materials_",
    "AGI_",
    "FB_",
    "GOOGLE_",
    "OMI_",
    "VRMC_",
];

/// How far a reader trusts a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// The most bytes that the file may take in memory, everything that is made of it included; [`memory::DEFAULT_LIMIT`] by default.
    pub memory_limit: u64,
    /// Allows devices and pipes, and buffers outside the model's directory. Off by default. Nothing is ever fetched from a network.
    pub any_path: bool,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            memory_limit: memory::DEFAULT_LIMIT,
            any_path: false,
        }
    }
}

/// A file whose JSON is parsed; meshes, clips and buffers are read when they are asked for.
#[derive(Debug)]
pub struct GltfFile {
    path: PathBuf,
    root: Root,
    buffers: Buffers,
    budget: MemoryBudget,
    parents: skin::Parents,
}

/// A mesh and what the file says about it beside its geometry.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundMesh {
    /// The mesh, without clips and without its skin ([`GltfFile::skin`]). Targets that the file stores nothing for are empty ([`MorphMesh::targets`]).
    pub mesh: MorphMesh,
    /// Whether a node shows it with a skin, which moves its vertices by bones.
    pub skinned: bool,
    /// What it draws where none of its primitives is made of triangles: `points`, `lines` or `points and lines`.
    pub not_triangles: Option<&'static str>,
}

impl GltfFile {
    /// Opens a file and parses its JSON.
    ///
    /// # Errors
    /// The file cannot be read, is no glTF, or needs an extension that changes how geometry is stored.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self, ReadError> {
        Self::open_within(path, options, MemoryBudget::new(options.memory_limit))
    }

    /// As [`GltfFile::open`] with a budget that other files may share, in place of [`ReadOptions::memory_limit`].
    ///
    /// # Errors
    /// As [`GltfFile::open`].
    pub fn open_within(path: &Path, options: &ReadOptions, budget: MemoryBudget) -> Result<Self, ReadError> {
        let io = |source| ReadError::Io {
            path: path.to_owned(),
            source,
        };
        // Asked before opening, because opening a pipe waits for its other end.
        let found = std::fs::metadata(path).map_err(io)?;
        if !found.is_file() && !found.is_dir() && !options.any_path {
            return Err(ReadError::NotRegular { path: path.to_owned() });
        }
        let file = std::fs::File::open(path).map_err(io)?;
        // What has no length beforehand grows while it is read, up to twice its length.
        let (length, growth) = if found.is_file() {
            (found.len(), 1)
        } else {
            (budget.left() / 4, 2)
        };
        let over = |over| ReadError::OverBudget {
            path: path.to_owned(),
            over,
        };
        budget.take(length, growth, || "the file".into()).map_err(over)?;
        let mut bytes = Vec::with_capacity(usize::try_from(if growth == 1 { length } else { 0 }).unwrap_or(0));
        file.take(length).read_to_end(&mut bytes).map_err(io)?;
        let directory = path.parent().unwrap_or(Path::new(""));
        Self::new(bytes, path, Some(directory), options, budget)
    }

    /// As [`GltfFile::open`] from a file's bytes; buffers must be within them. `path` is only for messages.
    ///
    /// # Errors
    /// As [`GltfFile::open`].
    pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Self, ReadError> {
        let budget = MemoryBudget::new(options.memory_limit);
        let over = |over| ReadError::OverBudget {
            path: path.to_owned(),
            over,
        };
        budget.take(bytes.len() as u64, 1, || "the file".into()).map_err(over)?;
        Self::new(bytes.to_vec(), path, None, options, budget)
    }

    fn new(
        bytes: Vec<u8>,
        path: &Path,
        directory: Option<&Path>,
        options: &ReadOptions,
        budget: MemoryBudget,
    ) -> Result<Self, ReadError> {
        let not_gltf = |reason: String| ReadError::NotGltf {
            path: path.to_owned(),
            reason,
        };
        let (json, chunk) = if bytes.starts_with(b"glTF") {
            let (json, chunk) = chunks(&bytes).map_err(not_gltf)?;
            (json, chunk)
        } else {
            (0..bytes.len(), None)
        };
        let root = Root::parse(&bytes[json], &budget).map_err(|error| match error {
            RootError::Json(error) => not_gltf(error.to_string()),
            RootError::OverBudget(over) => ReadError::OverBudget {
                path: path.to_owned(),
                over,
            },
        })?;
        let unknown = |name: &&String| !HARMLESS.iter().any(|harmless| name.starts_with(harmless));
        if let Some(extension) = root.extensions_required.iter().find(unknown) {
            return Err(ReadError::Extension {
                path: path.to_owned(),
                extension: extension.clone(),
            });
        }
        Ok(Self {
            path: path.to_owned(),
            buffers: Buffers::new(&root, directory, options, bytes, chunk),
            root,
            budget,
            parents: skin::Parents::new(),
        })
    }

    /// The path it was opened with.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// This file and the ones that its buffers are in, whether they exist or not.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files = vec![self.path.clone()];
        files.extend(self.buffers.files(&self.root, &self.budget));
        files
    }

    /// What the file may still take in memory; whoever builds more of its meshes counts that here.
    #[must_use]
    pub fn budget(&self) -> &MemoryBudget {
        &self.budget
    }

    /// The number of meshes.
    #[must_use]
    pub fn mesh_count(&self) -> usize {
        self.root.meshes.len()
    }

    /// A mesh's name, or the one made up for it.
    #[must_use]
    pub fn mesh_name(&self, index: usize) -> String {
        let name = self
            .root
            .meshes
            .get(index, &self.budget)
            .ok()
            .and_then(|mesh| mesh.name.clone());
        name.unwrap_or_else(|| format!("mesh_{index}"))
    }

    /// Reads a mesh.
    ///
    /// Several primitives become one mesh: their vertices are joined (once, where primitives share them) and their triangles
    /// numbered through; strips and fans become triangles of the same winding; points and lines give an empty range. A mesh
    /// without triangles or without targets is returned as it is.
    ///
    /// # Errors
    /// [`ReadError::Mesh`] names the primitive and accessor at fault.
    pub fn mesh(&self, index: usize) -> Result<FoundMesh, ReadError> {
        let name = self.mesh_name(index);
        let fail = |problem| ReadError::Mesh {
            path: self.path.clone(),
            mesh: index,
            name: name.clone(),
            problem: Box::new(problem),
        };
        let json = self.root.meshes.get(index, &self.budget);
        let json = json.map_err(|problem| fail(MeshProblem::Element(problem)))?;
        let (mut mesh, drawn) = primitive::read(self, json).map_err(fail)?;
        mesh.target_names = target_names(json, mesh.targets.len());
        mesh.name = name;
        Ok(FoundMesh {
            mesh,
            skinned: self.skin_of(index, json).is_some(),
            not_triangles: match (drawn.triangles, drawn.points, drawn.lines) {
                (false, true, true) => Some("points and lines"),
                (false, true, false) => Some("points"),
                (false, false, true) => Some("lines"),
                _ => None,
            },
        })
    }

    /// All meshes with their clips, their skins and with every target in full.
    fn all_meshes(&self) -> Result<Vec<MorphMesh>, ReadError> {
        let read = |index: usize| {
            let mut mesh = self.mesh(index)?.mesh;
            let vertices = mesh.positions.len();
            for target in mesh.targets.iter_mut().filter(|target| target.is_empty()) {
                let what = || format!("the displacements of {vertices} vertices");
                let take = self.budget.take(vertices as u64, 12, what);
                take.map_err(|over| ReadError::Mesh {
                    path: self.path.clone(),
                    mesh: index,
                    name: mesh.name.clone(),
                    problem: Box::new(MeshProblem::OverBudget(over)),
                })?;
                *target = vec![glam::Vec3::ZERO; vertices];
            }
            mesh.animations = self.clips(index, mesh.targets.len()).clips;
            mesh.skin = self.skin(index)?;
            Ok(mesh)
        };
        (0..self.mesh_count()).map(read).collect()
    }
}

/// Reads every mesh of a file, in file order, as [`GltfFile::mesh`] does, with its clips, its skin and with every target in full.
///
/// Clips that cannot be played are left out; [`GltfFile::clips`] and [`GltfFile::joint_clips`] say why.
///
/// # Errors
/// [`ReadError`] names the file, and the mesh, primitive and accessor at fault. A mesh whose skin is broken is an error.
pub fn read_meshes(path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    GltfFile::open(path, &ReadOptions::default())?.all_meshes()
}

/// As [`read_meshes`] from a file's bytes; buffers must be within them. `path` is only for messages.
///
/// # Errors
/// As [`read_meshes`].
pub fn parse_meshes(bytes: &[u8], path: &Path) -> Result<Vec<MorphMesh>, ReadError> {
    GltfFile::parse(bytes, path, &ReadOptions::default())?.all_meshes()
}

/// Where in a `.glb` its JSON is, and its binary chunk if it has one.
fn chunks(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), String> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|word| <[u8; 4]>::try_from(word).ok());
        word.map(|word| u32::from_le_bytes(word) as usize)
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        let length = bytes.len();
        return Err(format!("the file ends after {length} bytes, inside the glb header"));
    };
    if version != 2 {
        return Err(format!("the glb header has version {version}"));
    }
    if length < GLB_HEADER || length > bytes.len() {
        let found = bytes.len();
        return Err(format!("the glb header promises {length} bytes, the file has {found}"));
    }
    let chunk = |at: usize, kind: &[u8; 4]| -> Result<Option<Range<usize>>, String> {
        let Some(size) = word(at) else { return Ok(None) };
        let start = at + 8;
        if bytes.get(at + 4..start) != Some(kind) {
            return Ok(None);
        }
        let end = start.checked_add(size).filter(|&end| end <= length);
        let end = end.ok_or_else(|| format!("the glb chunk at byte {at} reaches beyond the end"))?;
        Ok(Some(start..end))
    };
    let json = chunk(GLB_HEADER, b"JSON")?.ok_or("the glb file does not begin with a JSON chunk")?;
    let binary = chunk(json.end.next_multiple_of(4), b"BIN\0")?;
    Ok((json, binary))
}

/// The names that most exporters put into the mesh's extras, made up where they are missing.
fn target_names(mesh: &Mesh, count: usize) -> Vec<String> {
    #[derive(serde::Deserialize)]
    struct Extras {
        #[serde(rename = "targetNames")]
        target_names: Vec<String>,
    }
    let mut names = mesh
        .extras
        .as_ref()
        .and_then(|extras| serde_json::from_str::<Extras>(extras.get()).ok())
        .map(|extras| extras.target_names)
        .unwrap_or_default();
    names.truncate(count);
    names.extend((names.len()..count).map(|target| format!("target_{target}")));
    names
}
