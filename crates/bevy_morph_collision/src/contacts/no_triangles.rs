//! The triangles of values that reflection creates.

use morph_collision::TrianglePair;

/// The triangles of a value created by reflection. Types of [`morph_collision`] are not reflected.
pub(crate) fn no_triangles() -> TrianglePair {
    TrianglePair {
        triangle_a: NO_TRIANGLE,
        triangle_b: NO_TRIANGLE,
    }
}

/// The triangle number used for colliders without triangles.
pub(crate) const NO_TRIANGLE: u32 = u32::MAX;
