//! The measurements of `inspect`, structured like their JSON.

use morph_collision::ModelError;
use serde::Serialize;
use thiserror::Error;

use super::expression::ExpressionReport;
use super::node::DrawnNodes;
use super::{AnimationReport, FileAnimationReport, NodeReport, SkinReport, UsableReport};
use crate::gltf::read::{Clips, Drawing, Extent, FoundMesh, GltfFile, JointClips, ReadError, Remedy};
use crate::left_out::LeftOut;
use crate::memory::OverBudget;
use crate::mesh::MorphMesh;
use crate::text::Printable;

/// Why a mesh cannot collide.
#[derive(Debug, Error)]
pub enum MeshError {
    /// It is not a valid model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Its tree would exceed the file's memory limit.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// Its skin cannot be read.
    #[error("its skin cannot be read: {}", without_file(.0))]
    Skin(Box<ReadError>),
    /// It cannot be posed at rest.
    #[error("its rest pose cannot be used: {0}")]
    Pose(String),
    /// It is not made of triangles.
    #[error("it is made of {0}, and only triangles collide")]
    NotTriangles(&'static str),
}

impl MeshError {
    /// The option that would let the mesh through, if there is one.
    #[must_use]
    pub fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget(_) => Some(Remedy::MoreMemory),
            Self::Skin(error) => error.remedy(),
            Self::Model(error) => match error {
                ModelError::IndexOutOfRange { .. }
                | ModelError::JointOutOfRange { .. }
                | ModelError::BadInfluence { .. }
                | ModelError::WeightsTooLarge { .. }
                | ModelError::BadCoordinate { .. } => Some(Remedy::SkipBad),
                _ => None,
            },
            Self::Pose(_) | Self::NotTriangles(_) => None,
        }
    }
}

/// A file and its meshes, in file order.
#[derive(Debug, Serialize)]
pub struct FileReport {
    /// The file's name as it was given.
    pub file: String,
    /// What extensions do to posed meshes and is not applied, see [`GltfFile::extension_notes`].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub extension_notes: Vec<String>,
    /// Problems that do not belong to a mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// All animations.
    pub animations: Vec<FileAnimationReport>,
    /// The expressions of an avatar (VRM).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub expressions: Vec<ExpressionReport>,
    /// All meshes, usable or not, or those that were asked for.
    pub meshes: Vec<MeshReport>,
}

/// One mesh; either `error` or `usable` is set.
#[derive(Debug, Serialize)]
pub struct MeshReport {
    /// Its index in the file.
    pub index: usize,
    /// Its name, or a default name.
    pub name: String,
    /// Vertices as the file stores them, split at seams.
    pub vertices_stored: usize,
    /// Triangles of all primitives.
    pub triangles: usize,
    /// Number of parts; usually each has its own material.
    pub primitives: usize,
    /// Whether it has no targets.
    pub rigid: bool,
    /// Whether joints move its vertices.
    pub skinned: bool,
    /// The nodes that show it.
    pub nodes: Vec<NodeReport>,
    /// The joints and how they move it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skin: Option<SkinReport>,
    /// Clips that animate its weights.
    pub animations: Vec<AnimationReport>,
    /// Warnings about clips that cannot be played.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// What was left out of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<LeftOut>,
    /// Data that only a mesh that can collide has.
    #[serde(flatten)]
    pub usable: Option<UsableReport>,
    /// Why it cannot collide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

impl FileReport {
    /// Reads every mesh of a file and builds a tree for every mesh that allows it.
    ///
    /// Only one mesh is kept in memory at a time.
    #[must_use]
    pub fn read(file: &GltfFile) -> Self {
        Self::read_meshes(file, 0..file.mesh_count(), |_| {})
    }

    /// Like [`FileReport::read`], for some of the meshes. Calls `before` with the index of each mesh before it is read.
    #[must_use]
    pub fn read_meshes(
        file: &GltfFile,
        meshes: impl IntoIterator<Item = usize>,
        mut before: impl FnMut(usize),
    ) -> Self {
        let drawing = file.drawing(Extent::DefaultScene);
        let drawn = DrawnNodes::of(drawing.as_ref().unwrap_or(&Drawing::default()));
        let report = |index| {
            before(index);
            file.budget().lend(|| MeshReport::read(file, index, &drawn))
        };
        let animations = file.animations().into_iter().enumerate();
        let broken = drawing
            .as_ref()
            .map_or_else(std::slice::from_ref, |drawing| &drawing.broken);
        let strays = file.stray_animations();
        Self {
            file: file.path().display().to_string(),
            extension_notes: file.extension_notes(),
            warnings: broken.iter().chain(&strays).map(ToString::to_string).collect(),
            animations: animations
                .map(|(index, info)| FileAnimationReport::new(index, info))
                .collect(),
            expressions: file.expressions().into_iter().map(ExpressionReport::new).collect(),
            meshes: meshes.into_iter().map(report).collect(),
        }
    }

    /// `None` if any mesh is usable, else the first error.
    #[must_use]
    pub fn why_unusable(&self) -> Option<String> {
        if self.meshes.iter().any(|mesh| mesh.usable.is_some()) {
            return None;
        }
        let Some(first) = self.meshes.first() else {
            return Some("the file has no mesh".into());
        };
        let error = first.error.as_deref().unwrap_or_default();
        Some(format!("mesh {} \"{}\": {error}", first.index, Printable(&first.name)))
    }
}

impl MeshReport {
    fn read(file: &GltfFile, index: usize, drawn: &DrawnNodes) -> Self {
        let mut found = match file.mesh(index) {
            Ok(found) => found,
            Err(error) => {
                return Self {
                    nodes: NodeReport::all(file, index, drawn),
                    ..Self::broken(file, index, &error)
                };
            }
        };
        let clips = file.clips(index, None, found.mesh.targets.len());
        let joint_clips = file.joint_clips(index, None);
        let skin = file.skin(index, None).map(|skin| found.mesh.skin = skin);
        let mut warnings = Vec::new();
        match file.default_weights(index, None, found.mesh.targets.len()) {
            Ok(weights) => found.mesh.default_weights = weights,
            Err(error) => warnings.push(without_file(&error)),
        }
        let mut skipped = None;
        let usable = || {
            skin.map_err(|error| MeshError::Skin(Box::new(error)))?;
            skipped = LeftOut::of(file, &mut found)?;
            let mesh = found.check_triangles()?;
            let bytes = mesh.tree_bytes().saturating_add(mesh.body_bytes(false));
            file.budget().take(bytes, 1, || "its tree".into())?;
            UsableReport::new(mesh)
        };
        let usable = usable();
        let mut report = Self::of(index, &found.mesh, &clips, &joint_clips, usable);
        report.left_out = skipped;
        report.skinned = found.skinned;
        report.nodes = NodeReport::all(file, index, drawn);
        warnings.extend(clips.broken.iter().map(left_out));
        warnings.extend(joint_clips.broken.iter().map(left_out));
        report.warnings = warnings;
        report
    }

    fn of(
        index: usize,
        mesh: &MorphMesh,
        clips: &Clips,
        joint_clips: &JointClips,
        usable: Result<UsableReport, MeshError>,
    ) -> Self {
        let sources = clips.animations.iter().zip(&clips.interpolations);
        let (usable, error) = match usable {
            Ok(usable) => (Some(usable), None),
            Err(error) => (None, Some(format!("{error}{}", Remedy::hint(error.remedy())))),
        };
        Self {
            index,
            name: mesh.name.clone(),
            vertices_stored: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            primitives: mesh.primitives.len(),
            rigid: mesh.targets.is_empty(),
            skinned: false,
            nodes: Vec::new(),
            skin: mesh
                .skin
                .as_ref()
                .map(|skin| SkinReport::new(skin, &joint_clips.animations)),
            animations: (clips.clips.iter().zip(sources))
                .map(|(clip, (&animation, &interpolation))| {
                    AnimationReport::new(clip, animation, interpolation, mesh.targets.len())
                })
                .collect(),
            warnings: Vec::new(),
            left_out: None,
            usable,
            error,
        }
    }

    /// The report of a mesh that cannot be read.
    fn broken(file: &GltfFile, index: usize, error: &ReadError) -> Self {
        Self {
            index,
            name: file.mesh_name(index),
            vertices_stored: 0,
            triangles: 0,
            primitives: 0,
            rigid: false,
            skinned: false,
            nodes: Vec::new(),
            skin: None,
            animations: Vec::new(),
            warnings: Vec::new(),
            left_out: None,
            usable: None,
            error: Some(match error {
                ReadError::Mesh { problem, .. } => format!("{problem}{}", Remedy::hint(error.remedy())),
                other => other.to_string(),
            }),
        }
    }
}

/// The error without the names of the file and the mesh, which are printed above it.
fn without_file(error: &ReadError) -> String {
    match error {
        ReadError::Skin { problem, .. } => problem.to_string(),
        ReadError::Mesh { problem, .. } => problem.to_string(),
        other => other.to_string(),
    }
}

/// The error without the file's name, which is printed above it.
fn left_out(error: &ReadError) -> String {
    match error {
        ReadError::Animation {
            animation,
            name,
            problem,
            ..
        } => format!(
            "animation {animation} \"{}\" is left out: {problem}{}",
            Printable(name),
            Remedy::hint(error.remedy())
        ),
        other => other.to_string(),
    }
}

impl FoundMesh {
    /// The mesh, if it has triangles.
    ///
    /// # Errors
    /// [`MeshError::NotTriangles`] for a mesh of points or lines.
    pub fn check_triangles(&self) -> Result<&MorphMesh, MeshError> {
        match self.not_triangles {
            Some(what) => Err(MeshError::NotTriangles(what)),
            None => Ok(&self.mesh),
        }
    }
}
