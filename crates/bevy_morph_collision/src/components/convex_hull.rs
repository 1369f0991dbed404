//! Convex hulls as shapes.

use std::fmt;
use std::sync::Arc;

use bevy::prelude::*;
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use morph_collision::{ConvexHull, HullError, InputError};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// The convex hull of points, for [`MorphShape::ConvexHull`](super::MorphShape::ConvexHull). Cloning it is cheap.
///
/// Every test looks at each corner, so a hull of few points is fast: take a coarse mesh, or a few points of it. An entity with a scale scales the hull
/// whenever it moves; for a hull of many points, scale the points instead.
///
/// Reflection sees it as one value. In files it is a list of at most 65,536 points; the hull of more is made by [`MorphConvexHull::new`], and what
/// is written of it are its corners.
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
#[serde(try_from = "Points", into = "Vec<[f32; 3]>")]
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

/// The points of a hull in a file.
#[derive(Deserialize)]
#[serde(transparent)]
struct Points(#[serde(deserialize_with = "at_most")] Vec<[f32; 3]>);

/// At most so many points are read from a file.
const MOST_POINTS: usize = 65_536;

/// Reads a list of points that is not too long, without its rest.
fn at_most<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<[f32; 3]>, D::Error> {
    struct List;
    impl<'de> Visitor<'de> for List {
        type Value = Vec<[f32; 3]>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "at most {MOST_POINTS} points of a convex hull")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
            let mut points = Vec::new();
            while let Some(point) = list.next_element()? {
                if points.len() == MOST_POINTS {
                    return Err(A::Error::invalid_length(MOST_POINTS + 1, &self));
                }
                points.push(point);
            }
            Ok(points)
        }
    }
    deserializer.deserialize_seq(List)
}

impl TryFrom<Points> for MorphConvexHull {
    type Error = HullError;

    fn try_from(Points(points): Points) -> Result<Self, HullError> {
        let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
        Self::new(&points)
    }
}

impl From<MorphConvexHull> for Vec<[f32; 3]> {
    fn from(hull: MorphConvexHull) -> Self {
        hull.0.points().iter().map(|point| point.as_vec3().to_array()).collect()
    }
}
