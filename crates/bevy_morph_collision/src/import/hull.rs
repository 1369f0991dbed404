//! Convex hulls of meshes.

use bevy::prelude::*;

use super::decode::Positions;
use super::error::ImportError;
use crate::components::MorphConvexHull;

impl MorphConvexHull {
    /// Builds the convex hull of a mesh's vertices as they are stored, without morph targets and joints. A few thousand vertices take
    /// milliseconds.
    ///
    /// # Errors
    /// [`ImportError`] if the positions are missing or cannot be read, or as for [`MorphConvexHull::new`].
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// let barrel = Mesh::from(Cylinder::new(0.4, 1.0));
    /// let hull = MorphConvexHull::of_mesh(&barrel)?;
    /// assert!(hull.hull().points().len() < barrel.count_vertices());
    /// # Ok::<(), bevy_morph_collision::import::ImportError>(())
    /// ```
    pub fn of_mesh(mesh: &Mesh) -> Result<Self, ImportError> {
        let positions = Positions::of(mesh)?;
        let mut points = Vec::new();
        let mut left = positions.len();
        positions.copy(&mut points, &mut left);
        Ok(Self::new(&points)?)
    }
}
