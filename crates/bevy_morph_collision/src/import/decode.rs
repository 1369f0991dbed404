//! Decodes compressed vertex attributes in the same way as Bevy's shaders.
//!
//! `MeshCompressionArgs` stores positions relative to `Mesh::final_aabb`, and texture coordinates relative to their range. The shader computes
//! `center + half_size * value` and `min + size * value` in `f32`; here the product is rounded before it is added, as in WGSL without
//! contraction. Morph displacements are never compressed.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy::shape::BoundingVolume;

use super::copy::copy;
use super::error::ImportError;

/// The positions of a mesh, in any supported format.
pub(super) enum Positions<'a> {
    Plain(&'a [[f32; 3]]),
    /// Relative to a box; the fourth number is unused.
    Compressed {
        values: &'a [[i16; 4]],
        center: Vec3,
        half_size: Vec3,
    },
}

impl<'a> Positions<'a> {
    pub(super) fn of(mesh: &'a Mesh) -> Result<Self, ImportError> {
        match mesh.try_attribute(Mesh::ATTRIBUTE_POSITION.id)? {
            VertexAttributeValues::Float32x3(values) => Ok(Self::Plain(values)),
            VertexAttributeValues::Snorm16x4(values) => {
                let bounds = mesh.final_aabb.ok_or(ImportError::NoPositionBounds)?;
                Ok(Self::Compressed {
                    values,
                    center: bounds.center().into(),
                    half_size: bounds.half_size().into(),
                })
            }
            other => Err(ImportError::PositionFormat(other.enum_variant_name())),
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Plain(values) => values.len(),
            Self::Compressed { values, .. } => values.len(),
        }
    }

    /// Copies at most `left` more positions. Returns whether the copy is complete.
    pub(super) fn copy(&self, into: &mut Vec<Vec3>, left: &mut usize) -> bool {
        match *self {
            Self::Plain(values) => copy(into, values, left, |&p| p.into()),
            Self::Compressed {
                values,
                center,
                half_size,
            } => copy(into, values, left, |&[x, y, z, _]| {
                center + half_size * Vec3::from_array([x, y, z].map(snorm16))
            }),
        }
    }
}

/// The texture coordinates of a vertex; `None` if the mesh has none that can be read.
pub(crate) fn uv_of(mesh: &Mesh, vertex: usize) -> Option<Vec2> {
    let uv = match mesh.try_attribute(Mesh::ATTRIBUTE_UV_0.id).ok()? {
        VertexAttributeValues::Float32x2(values) => *values.get(vertex)?,
        VertexAttributeValues::Float16x2(values) => values.get(vertex)?.map(f32::from),
        VertexAttributeValues::Unorm8x2(values) => values.get(vertex)?.map(unorm8),
        VertexAttributeValues::Snorm16x2(values) => values.get(vertex)?.map(snorm16),
        VertexAttributeValues::Snorm8x2(values) => values.get(vertex)?.map(snorm8),
        VertexAttributeValues::Unorm16x2(values) => {
            let value = Vec2::from_array(values.get(vertex)?.map(unorm16));
            // Without a range, the values are only quantized and used directly.
            return Some(match mesh.final_uv_ranges[0] {
                Some(range) => range.min + (range.max - range.min) * value,
                None => value,
            });
        }
        _ => return None,
    };
    Some(Vec2::from_array(uv))
}

// GPUs decode them like this.
pub(super) fn unorm16(value: u16) -> f32 {
    f32::from(value) / 65535.0
}
pub(super) fn unorm8(value: u8) -> f32 {
    f32::from(value) / 255.0
}
pub(super) fn snorm16(value: i16) -> f32 {
    (f32::from(value) / 32767.0).max(-1.0)
}
pub(super) fn snorm8(value: i8) -> f32 {
    (f32::from(value) / 127.0).max(-1.0)
}
