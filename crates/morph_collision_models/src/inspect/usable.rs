//! The part of a report about a mesh that can collide: its bounds, its targets and its tree.

use std::sync::Arc;

use glam::Vec3;
use morph_collision::{BuildOptions, JointMatrices, MorphBvh, MorphModel, Pose, WorldFromModel};
use serde::Serialize;

use super::MeshError;
use crate::mesh::MorphMesh;

/// Data that only a mesh that can collide has.
#[derive(Debug, Serialize)]
pub struct UsableReport {
    /// Vertices after those in the same place are welded.
    pub vertices_welded: usize,
    /// The box around its triangles at rest: with its default weights and, if it is skinned, the joints' rest pose.
    pub bounds: BoundsReport,
    /// One per target.
    pub targets: Vec<TargetReport>,
    /// The tree of the default options.
    pub tree: TreeReport,
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoundsReport {
    /// The smallest coordinates.
    pub min: [f32; 3],
    /// The largest coordinates.
    pub max: [f32; 3],
}

/// What a target does.
#[derive(Debug, Serialize)]
pub struct TargetReport {
    /// Its name, or a default name.
    pub name: String,
    /// Its weight unless a clip or a caller sets another.
    pub default_weight: f32,
    /// The longest displacement: how far it moves a vertex at weight 1.
    pub reach: f32,
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

impl UsableReport {
    pub(super) fn new(mesh: &MorphMesh) -> Result<Self, MeshError> {
        let model = Arc::new(mesh.to_model()?);
        let bvh = Arc::new(MorphBvh::build(Arc::clone(&model), &BuildOptions::default()));
        let weights = mesh.weights_at_rest();
        Ok(Self {
            vertices_welded: model.vertex_count(),
            bounds: BoundsReport::of(mesh, &weights, &bvh)?,
            targets: (0..model.target_count())
                .map(|target| TargetReport::new(mesh, &model, target, weights[target]))
                .collect(),
            tree: TreeReport {
                nodes: bvh.node_count(),
                depth: bvh.depth(),
                bytes: bvh.bytes(),
            },
        })
    }
}

impl BoundsReport {
    fn of(mesh: &MorphMesh, weights: &[f32], bvh: &Arc<MorphBvh>) -> Result<Self, MeshError> {
        let mut pose = Pose::new(Arc::clone(bvh));
        pose.set_weights(weights)
            .map_err(|error| MeshError::Pose(error.to_string()))?;
        if let Some(skin) = &mesh.skin {
            let joints = JointMatrices::new(&skin.skeleton.at_rest());
            let set = joints.and_then(|joints| pose.set_joints(&joints));
            set.map_err(|error| MeshError::Pose(error.to_string()))?;
        }
        let bounds = pose.tight_world_bounds(&WorldFromModel::IDENTITY);
        Ok(Self {
            min: bounds.min.to_array(),
            max: bounds.max.to_array(),
        })
    }

    /// The lengths of its sides.
    #[must_use]
    pub fn size(&self) -> [f32; 3] {
        std::array::from_fn(|axis| self.max[axis] - self.min[axis])
    }
}

impl TargetReport {
    fn new(mesh: &MorphMesh, model: &MorphModel, target: usize, default_weight: f32) -> Self {
        let vertices_moved = model.displaced_vertex_count(target as u32);
        // Lengths of displacements near the largest `f32` are only correct in `f64`.
        let length = |displacement: &Vec3| displacement.as_dvec3().length() as f32;
        Self {
            name: mesh.target_names.get(target).cloned().unwrap_or_default(),
            default_weight,
            reach: mesh.targets[target].iter().map(length).fold(0.0, f32::max),
            vertices_moved,
            share_left_alone: 1.0 - vertices_moved as f64 / model.vertex_count() as f64,
        }
    }
}
