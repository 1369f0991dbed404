//! Checks of a mesh's positions, displacements and triangles.

use super::ModelError;
use super::morph_model::LARGEST;
use super::targets::TargetDisplacements;

pub(super) fn count(what: &'static str, count: usize, limit: usize) -> Result<(), ModelError> {
    if count > limit {
        return Err(ModelError::TooMany { what, count, limit });
    }
    Ok(())
}

/// Checks that a shape has `expected` vectors, and that their coordinates are finite and in range.
pub(super) fn vectors(shape: &str, vectors: &impl TargetDisplacements, expected: usize) -> Result<(), ModelError> {
    if vectors.vertex_count() != expected {
        return Err(ModelError::LengthMismatch {
            shape: shape.to_owned(),
            length: vectors.vertex_count(),
            expected,
        });
    }
    for (stored, vector) in vectors.stored().iter().enumerate() {
        let is_bad = |value: &f32| !value.is_finite() || value.abs() > LARGEST;
        if let Some(value) = vector.to_array().into_iter().find(is_bad) {
            return Err(ModelError::BadCoordinate {
                shape: shape.to_owned(),
                vertex: vectors.vertex_of(stored),
                value,
            });
        }
    }
    Ok(())
}

pub(super) fn triangles(triangles: &[[u32; 3]], vertices: usize) -> Result<(), ModelError> {
    if triangles.is_empty() {
        return Err(ModelError::NoTriangles);
    }
    count("triangles", triangles.len(), i32::MAX as usize)?;
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(corner) = corners.iter().position(|&index| index as usize >= vertices) {
            return Err(ModelError::IndexOutOfRange {
                triangle,
                corner,
                index: corners[corner],
                vertices,
            });
        }
    }
    Ok(())
}
