//! Checks of a mesh's positions, displacements and triangles.

use super::ModelError;
use super::targets::TargetDisplacements;

/// The largest coordinate allowed in a mesh. It leaves room for sums in `f32`, whose range ends near 3.4e38 (docs/numerics.md).
pub(crate) const LARGEST: f32 = 1e37;

pub(super) fn count(what: &'static str, count: usize, limit: usize) -> Result<(), ModelError> {
    if count > limit {
        return Err(ModelError::TooMany { what, count, limit });
    }
    Ok(())
}

/// Checks the numbers of vertices, targets and triangles.
pub(super) fn sizes(vertices: usize, targets: usize, triangles: usize) -> Result<(), ModelError> {
    count("vertices", vertices, u32::MAX as usize / 4)?;
    count("targets", targets, u16::MAX as usize)?;
    count("triangles", triangles, i32::MAX as usize)
}

/// Checks that a shape has `expected` vectors.
pub(super) fn length(shape: &str, vectors: &impl TargetDisplacements, expected: usize) -> Result<(), ModelError> {
    if vectors.vertex_count() != expected {
        return Err(ModelError::LengthMismatch {
            shape: shape.to_owned(),
            length: vectors.vertex_count(),
            expected,
        });
    }
    Ok(())
}

/// The vertices with a coordinate that is not finite or too large, and that coordinate.
pub(super) fn bad_coordinates(vectors: &impl TargetDisplacements) -> impl Iterator<Item = (usize, f32)> {
    let is_bad = |value: &f32| !value.is_finite() || value.abs() > LARGEST;
    let stored = vectors.stored().iter().enumerate();
    stored.filter_map(move |(stored, vector)| {
        let value = vector.to_array().into_iter().find(is_bad)?;
        Some((vectors.vertex_of(stored), value))
    })
}

pub(super) fn bad_coordinate(shape: &str, vertex: usize, value: f32) -> ModelError {
    ModelError::BadCoordinate {
        shape: shape.to_owned(),
        vertex,
        value,
    }
}

/// Checks that a shape has `expected` vectors, and that their coordinates are finite and in range.
pub(super) fn vectors(shape: &str, vectors: &impl TargetDisplacements, expected: usize) -> Result<(), ModelError> {
    length(shape, vectors, expected)?;
    match bad_coordinates(vectors).next() {
        Some((vertex, value)) => Err(bad_coordinate(shape, vertex, value)),
        None => Ok(()),
    }
}

/// Checks that the corners of a triangle are vertices.
pub(super) fn corners(triangle: usize, corners: &[u32; 3], vertices: usize) -> Result<(), ModelError> {
    match corners.iter().position(|&index| index as usize >= vertices) {
        Some(corner) => Err(ModelError::IndexOutOfRange {
            triangle,
            corner,
            index: corners[corner],
            vertices,
        }),
        None => Ok(()),
    }
}

pub(super) fn triangles(triangles: &[[u32; 3]], vertices: usize) -> Result<(), ModelError> {
    if triangles.is_empty() {
        return Err(ModelError::NoTriangles);
    }
    let mut all = triangles.iter().enumerate();
    all.try_for_each(|(triangle, of)| corners(triangle, of, vertices))
}
