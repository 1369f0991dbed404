//! Meshes that collide without their bad triangles.

use morph_collision::BadParts;

use super::error::ImportError;

/// What was left out of a mesh because it is bad ([`MorphCollisionSettings::skip_bad_triangles`](crate::components::MorphCollisionSettings)).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MorphLeftOut {
    /// The number of triangles that are left out. The others are numbered without them.
    pub triangles: usize,
    /// The number of triangles of the mesh, with these.
    pub of_triangles: usize,
    /// What is wrong with the first bad vertex or triangle.
    pub reason: ImportError,
}

impl MorphLeftOut {
    /// What is left out of `triangles` triangles, and of an incomplete last one if there is a reason of its own; `None` if nothing is.
    pub(super) fn of(bad: &BadParts, triangles: usize, incomplete: Option<ImportError>) -> Option<Self> {
        let incomplete_triangles = usize::from(incomplete.is_some());
        let reason = bad.first().cloned().map(ImportError::Model).or(incomplete)?;
        Some(Self {
            triangles: bad.triangles().len() + incomplete_triangles,
            of_triangles: triangles + incomplete_triangles,
            reason,
        })
    }
}
