//! Convex hulls as shapes.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use morph_collision::{ConvexHull, HullError, InputError};
use serde::{Deserialize, Serialize};

/// The convex hull of points, for [`MorphShape::ConvexHull`](super::MorphShape::ConvexHull). Cloning it is cheap.
///
/// Every test looks at each corner, so a hull of few points is fast: take a coarse mesh, or a few points of it. An entity with a scale scales the hull
/// whenever it moves; for a hull of many points, scale the points instead.
///
/// Reflection sees it as one value. In files it is a list of points.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # fn spawn(mut commands: Commands) -> Result {
/// let wedge = MorphConvexHull::new(&[Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::Y, Vec3::ONE])?;
/// commands.spawn((MorphShape::from(wedge), Transform::from_xyz(0.0, 1.0, 0.0)));
/// # Ok(())
/// # }
/// # App::new().add_systems(Startup, spawn);
/// ```
#[derive(Reflect, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[reflect(opaque, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<[f32; 3]>", into = "Vec<[f32; 3]>")]
pub struct MorphConvexHull(Arc<ConvexHull>);

impl MorphConvexHull {
    /// Builds the convex hull of points. A few thousand points take milliseconds.
    ///
    /// For a mesh there is [`MorphConvexHull::of_mesh`].
    ///
    /// # Errors
    /// [`HullError`] if a point is not finite or beyond 1e37, if all points lie in one plane, or if the hull has more than
    /// [`ConvexHull::MAX_CORNERS`] corners.
    pub fn new(points: &[Vec3]) -> Result<Self, HullError> {
        Ok(Self(Arc::new(ConvexHull::new(points)?)))
    }

    /// Returns the hull, without the scale of an entity.
    #[must_use]
    pub fn hull(&self) -> &ConvexHull {
        &self.0
    }

    pub(super) fn scaled(&self, scale: Vec3) -> Result<Arc<ConvexHull>, InputError> {
        if scale == Vec3::ONE {
            Ok(Arc::clone(&self.0))
        } else {
            Ok(Arc::new(self.0.scaled(scale)?))
        }
    }
}

impl TryFrom<Vec<[f32; 3]>> for MorphConvexHull {
    type Error = HullError;

    fn try_from(points: Vec<[f32; 3]>) -> Result<Self, HullError> {
        let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
        Self::new(&points)
    }
}

impl From<MorphConvexHull> for Vec<[f32; 3]> {
    fn from(hull: MorphConvexHull) -> Self {
        hull.0.points().iter().map(|point| point.as_vec3().to_array()).collect()
    }
}
