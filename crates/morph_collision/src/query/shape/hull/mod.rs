//! Convex hulls of points.

mod quickhull;

use glam::{DVec3, Vec3};
use thiserror::Error;

use crate::input_error::{InputError, check_number, check_vector};
use quickhull::quickhull;

/// The convex hull of points, for [`Shape::ConvexHull`](crate::Shape::ConvexHull).
///
/// It is the exact hull of the `f32` points: its corners are some of them, and none of the others is outside. Build it once and share it;
/// placing it is cheap. A test against a triangle looks at every corner several times, so a hull of few points is fast.
///
/// ```
/// use std::sync::Arc;
/// use glam::{DVec3, Quat, Vec3};
/// use morph_collision::{ConvexHull, PlacedShape, Shape};
///
/// let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(0.1)];
/// let hull = ConvexHull::new(&corners)?;
/// assert_eq!(hull.points().len(), 4); // the last one is inside
/// let placed = PlacedShape::new(Shape::ConvexHull(Arc::new(hull)), Quat::IDENTITY, Vec3::ZERO)?;
/// assert_eq!(placed.signed_distance(DVec3::new(0.5, 0.25, -2.0)), 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexHull {
    points: Vec<DVec3>,
    /// The planes of the faces: unit normals out of the hull, and how far along each the hull reaches.
    pub(super) planes: Vec<(DVec3, f64)>,
    faces: Vec<[u32; 3]>,
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

/// Why points have no convex hull that can be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HullError {
    /// A point or a number is not finite, or is too large.
    #[error(transparent)]
    BadInput(#[from] InputError),
    /// The points lie in one plane, or there are fewer than four.
    #[error("the convex hull of {points} points has no volume: they lie in one plane; add a point beside it")]
    Flat {
        /// The number of points.
        points: usize,
    },
    /// The hull would have too many corners, and every test looks at each.
    #[error(
        "the convex hull of {points} points has more than {limit} corners; give it fewer points, such as those of a coarser mesh"
    )]
    TooManyCorners {
        /// The number of points given.
        points: usize,
        /// The largest number of corners.
        limit: usize,
    },
}

impl ConvexHull {
    /// The largest number of corners.
    pub const MAX_CORNERS: usize = 4096;

    /// Builds the convex hull of points, such as the vertices of a mesh. Its corners keep the order of the points.
    ///
    /// It takes at most `2 * MAX_CORNERS` steps. A step adds a corner; it looks at every face, and at the points outside of the faces that it
    /// replaces. The vertices of a character take a few milliseconds.
    ///
    /// # Errors
    /// [`HullError`] if a point is not finite or beyond 1e37, if all points lie in one plane, or if the hull has more than
    /// [`ConvexHull::MAX_CORNERS`] corners.
    pub fn new(points: &[Vec3]) -> Result<Self, HullError> {
        let is_good = |point: &Vec3| point.abs().cmple(Vec3::splat(1e37)).all();
        if let Some(index) = points.iter().position(|point| !is_good(point)) {
            check_vector(&format!("point {index}"), points[index].as_dvec3(), 1e37)?;
        }
        let exact: Vec<DVec3> = points.iter().map(|point| point.as_dvec3()).collect();
        let faces = quickhull(&exact, Self::MAX_CORNERS).map_err(|error| match error {
            quickhull::Failure::Flat => HullError::Flat { points: points.len() },
            quickhull::Failure::TooManyCorners => HullError::TooManyCorners {
                points: points.len(),
                limit: Self::MAX_CORNERS,
            },
        })?;
        Ok(Self::of_faces(&exact, faces))
    }

    /// Keeps the points that are corners of faces.
    fn of_faces(all: &[DVec3], mut faces: Vec<[u32; 3]>) -> Self {
        let mut corners: Vec<u32> = faces.iter().flatten().copied().collect();
        corners.sort_unstable();
        corners.dedup();
        for corner in faces.iter_mut().flatten() {
            *corner = corners.partition_point(|other| other < corner) as u32;
        }
        faces.sort_unstable();
        let points: Vec<DVec3> = corners.iter().map(|&corner| all[corner as usize]).collect();
        let normals = faces.iter().map(|face| {
            let [a, b, c] = face.map(|corner| points[corner as usize]);
            crate::exact::unit_normal(&[a, b, c])
        });
        // A thin face has a rough normal. The plane holds the hull all the same.
        let planes = normals
            .filter(|normal| *normal != DVec3::ZERO)
            .map(|normal| (normal, normal.dot(farthest(&points, normal))))
            .collect();
        let (low, high) = points
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), point| {
                (low.min(*point), high.max(*point))
            });
        Self {
            points,
            planes,
            faces,
            low,
            high,
        }
    }

    /// Returns the hull with every coordinate multiplied by a factor. Negative factors mirror it.
    ///
    /// # Errors
    /// [`InputError`] if a factor is zero, not finite, or beyond 1e18, or if the result is smaller than 1e-90 or larger than 1e50.
    pub fn scaled(&self, scale: Vec3) -> Result<Self, InputError> {
        for factor in scale.to_array() {
            let magnitude = f64::from(factor).abs();
            let is_good = magnitude > 0.0 && magnitude <= 1e18;
            check_number(
                "scale of a convex hull",
                f64::from(factor),
                is_good,
                "not 0, and at most 1e18",
            )?;
        }
        let scale = scale.as_dvec3();
        let is_mirrored = scale.x * scale.y * scale.z < 0.0;
        let along = |(normal, offset): &(DVec3, f64)| {
            let normal = *normal / scale;
            let length = normal.length();
            (normal / length, offset / length)
        };
        let (p, q) = (self.low * scale, self.high * scale);
        let size = p.abs().max(q.abs());
        let (least, most) = ((p - q).abs().min_element(), size.max_element());
        check_number("size of a convex hull", most, most <= 1e50, "at most 1e50")?;
        check_number("size of a convex hull", least, least >= 1e-90, "at least 1e-90")?;
        Ok(Self {
            points: self.points.iter().map(|point| *point * scale).collect(),
            planes: self.planes.iter().map(along).collect(),
            faces: (self.faces.iter())
                .map(|&[a, b, c]| if is_mirrored { [a, c, b] } else { [a, b, c] })
                .collect(),
            low: p.min(q),
            high: p.max(q),
        })
    }

    /// Returns the corners. Among them may be points between corners, on an edge or a face.
    #[must_use]
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Returns the triangles of the surface, as indices of corners, anticlockwise seen from outside.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The corner that lies farthest along a direction.
    pub(super) fn farthest(&self, direction: DVec3) -> DVec3 {
        farthest(&self.points, direction)
    }

    /// A point inside.
    pub(super) fn middle(&self) -> DVec3 {
        self.points.iter().sum::<DVec3>() / self.points.len() as f64
    }
}

fn farthest(points: &[DVec3], direction: DVec3) -> DVec3 {
    let mut best = (f64::NEG_INFINITY, DVec3::ZERO);
    for point in points {
        let along = direction.dot(*point);
        if along > best.0 {
            best = (along, *point);
        }
    }
    best.1
}
