//! What `inspect` measures, in the shape of its JSON.

use std::path::Path;
use std::sync::Arc;

use morph_collision::{BuildError, BuildOptions, ModelError, MorphBvh, MorphModel};
use serde::Serialize;
use thiserror::Error;

use crate::mesh::{MorphMesh, WeightAnimation};

/// Why a mesh cannot collide.
#[derive(Debug, Error)]
pub enum MeshError {
    /// It is no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No tree can be built of it.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// A file and its meshes, in file order.
#[derive(Debug, Serialize)]
pub struct FileReport {
    /// The name it was given.
    pub file: String,
    /// All of them, usable or not.
    pub meshes: Vec<MeshReport>,
}

/// One mesh; either `error` is set or `usable` is.
#[derive(Debug, Serialize)]
pub struct MeshReport {
    /// Its place in the file.
    pub index: usize,
    /// Its name, or one made up.
    pub name: String,
    /// Vertices as the file stores them, split at seams.
    pub vertices_stored: usize,
    /// Triangles of all primitives.
    pub triangles: usize,
    /// Parts, a material each, usually.
    pub primitives: usize,
    /// No target moves anything because there is none.
    pub rigid: bool,
    /// Clips that move its weights.
    pub animations: Vec<AnimationReport>,
    /// What it has if it can collide.
    #[serde(flatten)]
    pub usable: Option<UsableReport>,
    /// Why it cannot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// What only a mesh that can collide has.
#[derive(Debug, Serialize)]
pub struct UsableReport {
    /// Vertices once those in the same place are one.
    pub vertices_welded: usize,
    /// One per target.
    pub targets: Vec<TargetReport>,
    /// The tree of the default options.
    pub tree: TreeReport,
}

/// What a target does.
#[derive(Debug, Serialize)]
pub struct TargetReport {
    /// Its name, or one made up.
    pub name: String,
    /// Welded vertices that the target displaces.
    pub vertices_moved: usize,
    /// Share of the welded vertices that it leaves alone, 0 to 1.
    pub share_left_alone: f64,
}

/// How large a tree is.
#[derive(Debug, Serialize)]
pub struct TreeReport {
    /// Nodes.
    pub nodes: usize,
    /// Levels below the root.
    pub depth: usize,
    /// What it takes in memory, with the model that it is of.
    pub bytes: usize,
}

/// A clip's weights; between keys weights are linear, so that the keys hold the extremes.
#[derive(Debug, Serialize)]
pub struct AnimationReport {
    /// Its name, or one made up.
    pub name: String,
    /// Moments that it has weights for.
    pub keys: usize,
    /// How long it lasts.
    pub seconds: f32,
    /// One range per target.
    pub weights: Vec<WeightRange>,
    /// Of the sum of all weights at a key.
    pub weight_sum: WeightRange,
}

/// From the smallest to the largest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WeightRange {
    /// The smallest.
    pub min: f32,
    /// The largest.
    pub max: f32,
}

impl FileReport {
    /// Builds a tree of every mesh that one can be built of; `file` is only named.
    #[must_use]
    pub fn new(file: &Path, meshes: &[MorphMesh]) -> Self {
        let meshes = meshes
            .iter()
            .enumerate()
            .map(|(index, mesh)| MeshReport::new(index, mesh))
            .collect();
        Self {
            file: file.display().to_string(),
            meshes,
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
        Some(format!("mesh {} \"{}\": {error}", first.index, first.name))
    }
}

impl MeshReport {
    fn new(index: usize, mesh: &MorphMesh) -> Self {
        let (usable, error) = match UsableReport::new(mesh) {
            Ok(usable) => (Some(usable), None),
            Err(error) => (None, Some(error.to_string())),
        };
        Self {
            index,
            name: mesh.name.clone(),
            vertices_stored: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            primitives: mesh.primitives.len(),
            rigid: mesh.targets.is_empty(),
            animations: mesh
                .animations
                .iter()
                .map(|clip| AnimationReport::new(clip, mesh.targets.len()))
                .collect(),
            usable,
            error,
        }
    }
}

impl UsableReport {
    fn new(mesh: &MorphMesh) -> Result<Self, MeshError> {
        let model = Arc::new(mesh.to_model()?);
        let bvh = MorphBvh::build(Arc::clone(&model), &BuildOptions::default())?;
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

impl TargetReport {
    fn new(mesh: &MorphMesh, model: &MorphModel, target: usize) -> Self {
        let vertices_moved = model.displaced_vertex_count(target);
        Self {
            name: mesh.target_names.get(target).cloned().unwrap_or_default(),
            vertices_moved,
            share_left_alone: 1.0 - vertices_moved as f64 / model.vertex_count() as f64,
        }
    }
}

impl AnimationReport {
    fn new(clip: &WeightAnimation, targets: usize) -> Self {
        let of_target = |target: usize| clip.weights.iter().filter_map(move |key| key.get(target).copied());
        Self {
            name: clip.name.clone(),
            keys: clip.times.len(),
            seconds: clip.duration(),
            weights: (0..targets).map(|target| WeightRange::of(of_target(target))).collect(),
            weight_sum: WeightRange::of(clip.weights.iter().map(|key| key.iter().sum())),
        }
    }
}

impl WeightRange {
    /// Zero to zero if there is no weight: a clip without keys leaves weights at rest.
    fn of(weights: impl Iterator<Item = f32>) -> Self {
        weights
            .map(|weight| Self {
                min: weight,
                max: weight,
            })
            .reduce(|range, weight| Self {
                min: range.min.min(weight.min),
                max: range.max.max(weight.max),
            })
            .unwrap_or(Self { min: 0.0, max: 0.0 })
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
