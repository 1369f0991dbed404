//! What a mesh must be: the one door for positions, displacements and triangles.

use glam::Vec3;

use super::morph_model::LARGEST;
use super::{ModelError, Subject};

pub(super) fn count(what: &'static str, count: usize, limit: usize) -> Result<(), ModelError> {
    if count > limit {
        return Err(ModelError::TooMany { what, count, limit });
    }
    Ok(())
}

pub(super) fn length(subject: Subject, vectors: &[Vec3], expected: usize) -> Result<(), ModelError> {
    let length = vectors.len();
    if length != expected {
        return Err(ModelError::LengthMismatch {
            subject,
            length,
            expected,
        });
    }
    Ok(())
}

pub(super) fn positions(subject: Subject, positions: &[Vec3]) -> Result<(), ModelError> {
    for (vertex, position) in positions.iter().enumerate() {
        let bad = |value: &f32| !value.is_finite() || value.abs() > LARGEST;
        if let Some(value) = position.to_array().into_iter().find(bad) {
            return Err(ModelError::BadCoordinate { subject, vertex, value });
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
        for (corner, &index) in corners.iter().enumerate() {
            if index as usize >= vertices {
                return Err(ModelError::IndexOutOfRange {
                    triangle,
                    corner,
                    index,
                    vertices,
                });
            }
        }
    }
    Ok(())
}
