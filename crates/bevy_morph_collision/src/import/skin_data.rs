//! The joints that move the vertices of a [`Mesh`].

use bevy::mesh::{MeshVertexAttribute, VertexAttributeValues};
use bevy::prelude::*;
use morph_collision::{BadParts, Influences};

use super::copy::copy;
use super::decode::{snorm8, snorm16, unorm8, unorm16};
use super::error::ImportError;

/// A copy of a mesh's joint indices and weights, in any supported format.
pub(super) struct SkinData {
    joint_count: usize,
    joints: Vec<[u16; 4]>,
    weights: Vec<[f32; 4]>,
}

impl SkinData {
    /// Starts an empty copy for a skeleton with this many joints. `None` for a mesh that no joint moves.
    pub(super) fn of(mesh: &Mesh, joint_count: usize) -> Result<Option<Self>, ImportError> {
        let has = |attribute: MeshVertexAttribute| mesh.try_contains_attribute(attribute);
        // With only one of them, Bevy draws the mesh by its own transform.
        let is_skinned = has(Mesh::ATTRIBUTE_JOINT_INDEX)? && has(Mesh::ATTRIBUTE_JOINT_WEIGHT)?;
        Ok(is_skinned.then(|| Self {
            joint_count,
            joints: Vec::new(),
            weights: Vec::new(),
        }))
    }

    /// Copies the next part: the joints and weights of at most `left` vertices. Returns whether the copy is complete.
    pub(super) fn copy(&mut self, mesh: &Mesh, left: &mut usize) -> Result<bool, ImportError> {
        let attribute = |attribute: MeshVertexAttribute| mesh.try_attribute(attribute.id);
        let joints = &mut self.joints;
        let joints_complete = match attribute(Mesh::ATTRIBUTE_JOINT_INDEX)? {
            VertexAttributeValues::Uint16x4(values) => copy(joints, values, left, |&joints| joints),
            VertexAttributeValues::Uint8x4(values) => copy(joints, values, left, |joints| joints.map(u16::from)),
            other => return Err(ImportError::JointFormat(other.enum_variant_name())),
        };
        let weights = &mut self.weights;
        let weights_complete = match attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT)? {
            VertexAttributeValues::Float32x4(values) => copy(weights, values, left, |&weights| weights),
            VertexAttributeValues::Float16x4(values) => copy(weights, values, left, |w| w.map(f32::from)),
            VertexAttributeValues::Unorm16x4(values) => copy(weights, values, left, |w| w.map(unorm16)),
            VertexAttributeValues::Unorm8x4(values) => copy(weights, values, left, |w| w.map(unorm8)),
            VertexAttributeValues::Snorm16x4(values) => copy(weights, values, left, |w| w.map(snorm16)),
            VertexAttributeValues::Snorm8x4(values) => copy(weights, values, left, |w| w.map(snorm8)),
            other => return Err(ImportError::JointWeightFormat(other.enum_variant_name())),
        };
        Ok(joints_complete && weights_complete)
    }

    pub(super) fn joint_count(&self) -> usize {
        self.joint_count
    }

    /// Gives bad vertices the influences of a good one.
    pub(super) fn repair(&mut self, bad: &BadParts) {
        bad.repair(&mut self.joints);
        bad.repair(&mut self.weights);
    }

    pub(super) fn influences(&self) -> Influences<'_> {
        Influences {
            joints: &self.joints,
            weights: &self.weights,
        }
    }
}

/// The joints of a vertex with their weights. `None` if the mesh has none that can be read.
pub(crate) fn influences_of(mesh: &Mesh, vertex: usize) -> Option<impl Iterator<Item = (u16, f32)>> {
    let joints = match mesh.try_attribute(Mesh::ATTRIBUTE_JOINT_INDEX.id).ok()? {
        VertexAttributeValues::Uint16x4(values) => *values.get(vertex)?,
        VertexAttributeValues::Uint8x4(values) => values.get(vertex)?.map(u16::from),
        _ => return None,
    };
    let weights = match mesh.try_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT.id).ok()? {
        VertexAttributeValues::Float32x4(values) => *values.get(vertex)?,
        VertexAttributeValues::Float16x4(values) => values.get(vertex)?.map(f32::from),
        VertexAttributeValues::Unorm16x4(values) => values.get(vertex)?.map(unorm16),
        VertexAttributeValues::Unorm8x4(values) => values.get(vertex)?.map(unorm8),
        VertexAttributeValues::Snorm16x4(values) => values.get(vertex)?.map(snorm16),
        VertexAttributeValues::Snorm8x4(values) => values.get(vertex)?.map(snorm8),
        _ => return None,
    };
    Some(joints.into_iter().zip(weights))
}
