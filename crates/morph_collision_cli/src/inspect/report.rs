//! What `inspect` measures, in the shape of its JSON.

use std::path::Path;
use std::sync::Arc;

use morph_collision::{BuildOptions, MorphBvh, MorphModel};
use morph_collision_testkit::mesh::{MorphMesh, WeightAnimation};
use serde::Serialize;

use crate::error::MeshError;

/// A file and its meshes, in file order.
#[derive(Debug, Serialize)]
pub(crate) struct FileReport {
    pub(crate) file: String,
    pub(crate) meshes: Vec<MeshReport>,
}

/// One mesh; either `error` is set or `usable` is.
#[derive(Debug, Serialize)]
pub(crate) struct MeshReport {
    pub(crate) index: usize,
    pub(crate) name: String,
    /// Vertices as the file stores them, split at seams.
    pub(crate) vertices_stored: usize,
    pub(crate) triangles: usize,
    pub(crate) primitives: usize,
    /// No target moves anything because there is none.
    pub(crate) rigid: bool,
    pub(crate) animations: Vec<AnimationReport>,
    #[serde(flatten)]
    pub(crate) usable: Option<UsableReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<String>,
}

/// What only a mesh that can collide has.
#[derive(Debug, Serialize)]
pub(crate) struct UsableReport {
    pub(crate) vertices_welded: usize,
    pub(crate) targets: Vec<TargetReport>,
    pub(crate) tree: TreeReport,
}

#[derive(Debug, Serialize)]
pub(crate) struct TargetReport {
    pub(crate) name: String,
    /// Welded vertices that the target displaces.
    pub(crate) vertices_moved: usize,
    /// Share of the welded vertices that it leaves alone, 0 to 1.
    pub(crate) share_left_alone: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct TreeReport {
    pub(crate) nodes: usize,
    pub(crate) depth: usize,
    pub(crate) bytes: usize,
}

/// A clip's weights; between keys weights are linear, so that the keys hold the extremes.
#[derive(Debug, Serialize)]
pub(crate) struct AnimationReport {
    pub(crate) name: String,
    pub(crate) keys: usize,
    pub(crate) seconds: f32,
    /// One range per target.
    pub(crate) weights: Vec<WeightRange>,
    /// Of the sum of all weights at a key.
    pub(crate) weight_sum: WeightRange,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct WeightRange {
    pub(crate) min: f32,
    pub(crate) max: f32,
}

impl FileReport {
    pub(crate) fn new(file: &Path, meshes: &[MorphMesh]) -> Self {
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
    pub(crate) fn why_unusable(&self) -> Option<String> {
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
