//! The measurements of `inspect`, structured like their JSON.

use std::sync::Arc;

use morph_collision::{BuildOptions, ModelError, MorphBvh, MorphModel};
use serde::Serialize;
use thiserror::Error;

use super::SkinReport;
use crate::gltf_read::{FoundMesh, GltfFile, ReadError, Remedy};
use crate::memory::OverBudget;
use crate::mesh::{MorphMesh, WeightAnimation};
use crate::numbers::number;
use crate::printable::Printable;

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
    /// It is not made of triangles.
    #[error("it is made of {0}, and only triangles collide")]
    NotTriangles(&'static str),
}

impl MeshError {
    /// The option that would let the mesh through, if a limit refused it.
    #[must_use]
    pub fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget(_) => Some(Remedy::MoreMemory),
            Self::Skin(error) => error.remedy(),
            Self::Model(_) | Self::NotTriangles(_) => None,
        }
    }
}

/// A file and its meshes, in file order.
#[derive(Debug, Serialize)]
pub struct FileReport {
    /// The file's name as it was given.
    pub file: String,
    /// Problems that do not belong to a mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// All meshes, usable or not.
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
    /// The joints and how they move it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skin: Option<SkinReport>,
    /// Clips that animate its weights.
    pub animations: Vec<AnimationReport>,
    /// Warnings about clips that cannot be played.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Data that only a mesh that can collide has.
    #[serde(flatten)]
    pub usable: Option<UsableReport>,
    /// Why it cannot collide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// Data that only a mesh that can collide has.
#[derive(Debug, Serialize)]
pub struct UsableReport {
    /// Vertices after those in the same place are welded.
    pub vertices_welded: usize,
    /// One per target.
    pub targets: Vec<TargetReport>,
    /// The tree of the default options.
    pub tree: TreeReport,
}

/// What a target does.
#[derive(Debug, Serialize)]
pub struct TargetReport {
    /// Its name, or a default name.
    pub name: String,
    /// Welded vertices that the target displaces.
    pub vertices_moved: usize,
    /// Share of the welded vertices that it does not move, 0 to 1.
    pub share_left_alone: f64,
}

/// How large a tree is.
#[derive(Debug, Serialize)]
pub struct TreeReport {
    /// Nodes.
    pub nodes: usize,
    /// Levels below the root.
    pub depth: usize,
    /// Memory of the tree and its model, in bytes.
    pub bytes: usize,
}

/// A clip's weights, including overshoots between the keys of a cubic clip.
#[derive(Debug, Serialize)]
pub struct AnimationReport {
    /// Its name, or a default name.
    pub name: String,
    /// Number of keys.
    pub keys: usize,
    /// Its length in seconds.
    pub seconds: f32,
    /// One range per target.
    pub weights: Vec<WeightRange>,
    /// Sum of all weights, at the keys and between them.
    pub weight_sum: WeightRange,
}

/// A range of weights.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WeightRange {
    /// The smallest.
    #[serde(serialize_with = "number")]
    pub min: f64,
    /// The largest.
    #[serde(serialize_with = "number")]
    pub max: f64,
}

impl FileReport {
    /// Reads every mesh of a file and builds a tree for every mesh that allows it.
    ///
    /// Only one mesh is kept in memory at a time.
    #[must_use]
    pub fn read(file: &GltfFile) -> Self {
        let report = |index| file.budget().lend(|| MeshReport::read(file, index));
        Self {
            file: file.path().display().to_string(),
            warnings: file.stray_animations().iter().map(ToString::to_string).collect(),
            meshes: (0..file.mesh_count()).map(report).collect(),
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
    fn read(file: &GltfFile, index: usize) -> Self {
        let mut found = match file.mesh(index) {
            Ok(found) => found,
            Err(error) => return Self::broken(file, index, &error),
        };
        let clips = file.clips(index, found.mesh.targets.len());
        let skin = file.skin(index).map(|skin| found.mesh.skin = skin);
        let usable = || {
            skin.map_err(|error| MeshError::Skin(Box::new(error)))?;
            let mesh = found.check_triangles()?;
            let bytes = mesh.tree_bytes();
            file.budget().take(bytes, 1, || "its tree".into())?;
            UsableReport::new(mesh)
        };
        let mut report = Self::of(index, &found.mesh, &clips.clips, usable());
        report.skinned = found.skinned;
        report.warnings.extend(clips.broken.iter().map(left_out));
        report
            .warnings
            .extend(file.joint_clips(index).broken.iter().map(left_out));
        report
    }

    fn of(index: usize, mesh: &MorphMesh, clips: &[WeightAnimation], usable: Result<UsableReport, MeshError>) -> Self {
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
            skin: mesh.skin.as_ref().map(SkinReport::new),
            animations: clips
                .iter()
                .map(|clip| AnimationReport::new(clip, mesh.targets.len()))
                .collect(),
            warnings: Vec::new(),
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
            skin: None,
            animations: Vec::new(),
            warnings: Vec::new(),
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

impl UsableReport {
    fn new(mesh: &MorphMesh) -> Result<Self, MeshError> {
        let model = Arc::new(mesh.to_model()?);
        let bvh = MorphBvh::build(Arc::clone(&model), &BuildOptions::default());
        Ok(Self {
            vertices_welded: model.vertex_count(),
            targets: (0..model.target_count())
                .map(|target| TargetReport::new(mesh, &model, target))
                .collect(),
            tree: TreeReport {
                nodes: bvh.node_count(),
                depth: bvh.depth(),
                bytes: bvh.bytes(),
            },
        })
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

impl TargetReport {
    fn new(mesh: &MorphMesh, model: &MorphModel, target: usize) -> Self {
        let vertices_moved = model.displaced_vertex_count(target as u32);
        Self {
            name: mesh.target_names.get(target).cloned().unwrap_or_default(),
            vertices_moved,
            share_left_alone: 1.0 - vertices_moved as f64 / model.vertex_count() as f64,
        }
    }
}

impl AnimationReport {
    fn new(clip: &WeightAnimation, targets: usize) -> Self {
        Self {
            name: clip.name.clone(),
            keys: clip.times.len(),
            seconds: clip.duration(),
            weights: (0..targets).map(|target| WeightRange::of(clip.range(target))).collect(),
            weight_sum: WeightRange::of(clip.range_of_sum()),
        }
    }
}

impl WeightRange {
    /// Zero to zero if there is no weight, because a clip without keys leaves weights at rest.
    pub(super) fn of(range: Option<(f64, f64)>) -> Self {
        let (min, max) = range.unwrap_or_default();
        Self { min, max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_animation_is_the_extremes_of_its_keys() {
        let clip = WeightAnimation {
            name: "clip".into(),
            times: vec![0.0, 0.5, 2.0],
            weights: vec![vec![0.25, 1.0], vec![-0.5, 0.5], vec![0.0, 4.0]],
            tangents: Vec::new(),
        };
        let report = AnimationReport::new(&clip, 2);
        assert_eq!((report.keys, report.seconds), (3, 2.0));
        assert_eq!(
            report.weights,
            [WeightRange { min: -0.5, max: 0.25 }, WeightRange { min: 0.5, max: 4.0 }]
        );
        assert_eq!(report.weight_sum, WeightRange { min: 0.0, max: 4.0 });
    }

    #[test]
    fn a_clip_without_keys_leaves_all_weights_at_zero() {
        let report = AnimationReport::new(&WeightAnimation::default(), 1);
        assert_eq!(report.weights, [WeightRange { min: 0.0, max: 0.0 }]);
    }
}
